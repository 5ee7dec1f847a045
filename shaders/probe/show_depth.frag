// Self-test of slanted depths: shows the depths that the depth buffer has kept.
void main() {
    out_image = vec4(texelFetch(nearest, ivec2(gl_FragCoord.xy), 0).x);
}

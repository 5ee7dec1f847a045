// Trial of blending: shows what the target holds.
void main() {
    out_image = texelFetch(blended, ivec2(gl_FragCoord.xy), 0);
}

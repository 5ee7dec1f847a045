// Blend of dual depth peeling: blends the nearest layer just peeled behind the layers in front of it.
void main() {
    out_front = texelFetch(ahead, ivec2(gl_FragCoord.xy), 0);
}

// Trial of blending: shows the colour of the target, and in green the one of the second target if there is one.
void main() {
    out_image = texelFetch(blended, ivec2(gl_FragCoord.xy), 0);
#if BESIDE
    out_image.g = texelFetch(beside, ivec2(gl_FragCoord.xy), 0).r;
#endif
}

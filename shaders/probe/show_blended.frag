// Trial of blending: shows what the target holds, and in green what the one beside it does.
void main() {
    out_image = texelFetch(blended, ivec2(gl_FragCoord.xy), 0);
#if BESIDE
    out_image.g = texelFetch(beside, ivec2(gl_FragCoord.xy), 0).r;
#endif
}

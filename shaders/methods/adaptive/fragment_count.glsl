// Returns the number of fragments that the count pass found in this pixel.
uint fragment_count() {
    return uint(texelFetch(fragment_counts, ivec2(gl_FragCoord.xy), 0).x * float(DEEPEST) + 0.5);
}

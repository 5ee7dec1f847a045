// Returns the number of fragments that the count pass found in this pixel.
uint tallied() {
    return uint(texelFetch(tally, ivec2(gl_FragCoord.xy), 0).x * float(DEEPEST) + 0.5);
}

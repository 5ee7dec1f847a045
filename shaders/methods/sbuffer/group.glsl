// Gives the group of a pixel: which of the COUNTERS shared counters the pixel takes its address from.
// Invariant: the group is below COUNTERS for every pixel of every resolution.
uint pixel_group(uint p) {
#if HASH_TILE
    // A grid of nearly square tiles whose size follows the resolution (kplus_2015 §4.1).
    uint columns = uint(sqrt(float(COUNTERS)));
    uint rows = uint(COUNTERS) / columns;
    uvec2 tile = (uvec2(width, height) + uvec2(columns, rows) - 1u) / uvec2(columns, rows);
    return (p / width / tile.y) * columns + (p % width) / tile.x;
#else
    return p % uint(COUNTERS);  // H(P) = (Px + width Py) mod S (sbuffer_2012 §3.2)
#endif
}

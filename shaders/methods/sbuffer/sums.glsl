// Gives the first cell of a pixel's range from its place within its group: adds the totals of the groups before the
// pixel's own. With MAPPING_INVERSE the upper half of the groups is placed from the end, which halves the longest sum.
// Source: sbuffer_2012 §3.2, Eq. 1, with the first cell of the range in place of the last.
// Buffers: reads group_total.
#include "methods/sbuffer/group.glsl"

uint sum(uint from, uint to) {
    uint total = 0u;
    for (uint group = from; group < to; ++group) total += group_total[group];
    return total;
}

uint first_of_range(uint p, uint place, uint count) {
    uint group = pixel_group(p);
#if MAPPING_INVERSE
    if (group > uint(COUNTERS) / 2u) return capacity - sum(group + 1u, uint(COUNTERS)) - place - count;
#endif
    return place + sum(0u, group);
}

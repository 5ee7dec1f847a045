// Second half of the S-buffer's referencing: adds to each address the totals of the groups before the pixel's own. With
// MAPPING_INVERSE the upper half of the groups is placed from the end, which halves the longest sum.
// Invariant: the ranges of all pixels fill [0, capacity) without overlap. With BOUNDED the first cell of each is empty.
// Source: sbuffer_2012 §3.2, Eq. 1, with the first cell of the range in place of the last.
// Buffers: reads group_total, counter; updates address; writes nodes.
#include "common/pixel.glsl"
#include "common/payload.glsl"
#include "methods/sbuffer/group.glsl"

uint sum(uint from, uint to) {
    uint total = 0u;
    for (uint group = from; group < to; ++group) total += group_total[group];
    return total;
}

void main() {
    uint p = pixel_index();
    uint count = counter[p];
    if (count == 0u) return;
    uint group = pixel_group(p), first = address[p];
#if MAPPING_INVERSE
    if (group > uint(COUNTERS) / 2u) first = capacity - sum(group + 1u, uint(COUNTERS)) - first - count;
    else
#endif
    first += sum(0u, group);
    address[p] = first;
#if BOUNDED
    nodes[first] = NO_FRAGMENT;
#endif
}

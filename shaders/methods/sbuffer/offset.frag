// S-buffer referencing, second half: adds the sum of the groups before the pixel's own.
// With inverse mapping the upper half of the groups sums from the end, which halves the longest sum.
// Invariant: the ranges of all pixels fill [0, capacity) without overlap.
// Source: sbuffer_2012 §3.2, Eq. 1, with the range's first cell in place of its last.
#include "common/pixel.glsl"
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
    uint group = pixel_group(p);
#if MAPPING_INVERSE
    if (group > uint(COUNTERS) / 2u) {
        address[p] = capacity - sum(group + 1u, uint(COUNTERS)) - address[p] - count;
        return;
    }
#endif
    address[p] += sum(0u, group);
}

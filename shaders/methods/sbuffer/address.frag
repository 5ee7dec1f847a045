// S-buffer referencing, first half: each non-empty pixel takes its place within its group.
// Invariant: the ranges [address, address + counter) of a group's pixels do not overlap and leave no gap.
// With BOUNDED, counters that passed K are first taken back to it (kplus_2015 §4.1, Alg. 3, line 18).
// Source: sbuffer_2012 §3.2.
#include "common/pixel.glsl"
#include "methods/sbuffer/group.glsl"

void main() {
    uint p = pixel_index();
    uint count = counter[p];
#if BOUNDED
    count = min(count, uint(K));
    counter[p] = count;
#endif
    if (count > 0u) address[p] = atomicAdd(group_total[pixel_group(p)], count);
}

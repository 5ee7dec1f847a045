// S-buffer referencing, first half: each non-empty pixel takes its place within its group.
// Invariant: the ranges [address, address + counter) of a group's pixels do not overlap and leave no gap.
// Source: sbuffer_2012 §3.2.
#include "common/pixel.glsl"
#include "methods/sbuffer/group.glsl"

void main() {
    uint p = pixel_index();
    uint count = counter[p];
    if (count > 0u) address[p] = atomicAdd(group_total[pixel_group(p)], count);
}

// First half of the S-buffer's referencing: each pixel with fragments takes its place within its group, by one atomic
// on the shared counter of that group. With BOUNDED a counter beyond K is first limited to K (kplus_2015 §4.1, Alg. 3,
// line 18).
// Invariant: the ranges [address, address + counter) of the pixels of a group do not overlap and leave no gap.
// Source: sbuffer_2012 §3.2.
// Buffers: updates group_total, counter; writes address.
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

// Second half of the S-buffer's referencing: adds to each address the totals of the groups before the pixel's own. With
// SUMS_FRAGMENT the address stays a place within the group, and each fragment that is stored adds the totals for itself.
// Invariant: the ranges of all pixels fill [0, capacity) without overlap. With BOUNDED the first cell of each is empty.
// Source: sbuffer_2012 §3.2.
// Buffers: reads counter; updates address; writes nodes.
#include "common/pixel.glsl"
#include "common/payload.glsl"
#include "methods/sbuffer/sums.glsl"

void main() {
    uint p = pixel_index();
    uint count = counter[p];
    if (count == 0u) return;
    uint first = first_of_range(p, address[p], count);
#if !SUMS_FRAGMENT
    address[p] = first;
#endif
#if BOUNDED
    nodes[first] = NO_FRAGMENT;
#endif
}

// Store into the pixel's contiguous range: the address moves on with every fragment.
// Invariant: afterwards the range is [address - counter, address).
// Source: sbuffer_2012 §3.3.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint slot = atomicAdd(address[pixel_index()], 1u);
    if (slot < capacity) nodes[slot] = incoming();
    else atomicAdd(lost_fragments, 1u);
}

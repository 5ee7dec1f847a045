// Store into contiguous ranges: each fragment takes the cell at the address of its pixel and increments the address.
// Invariant: afterwards the range of the pixel is [address - counter, address).
// Source: sbuffer_2012 §3.3.
// Buffers: updates address; writes nodes.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint slot = atomicAdd(address[pixel_index()], 1u);
    if (slot < capacity) nodes[slot] = incoming();
    else atomicAdd(lost_fragments, 1u);
}

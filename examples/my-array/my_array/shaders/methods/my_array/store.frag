// Store: the atomic counter of the pixel gives each fragment a slot of its own.
// Invariant: slots 0 .. counter[p] - 1 of pixel p are written.
// Source: Crassin 2010.
// Buffers: updates counter; writes nodes.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    uint slot = atomicAdd(counter[p], 1u);
    if (slot < uint(N)) nodes[slot * pixels + p] = incoming();
    else atomicAdd(lost_fragments, 1u);
}

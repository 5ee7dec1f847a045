// Store of the A-buffer with fixed arrays: the atomic counter of the pixel gives each fragment a slot of its own.
// Invariant: slots 0 .. counter[p] - 1 of pixel p are written; a fragment beyond slot SLOTS - 1 is counted as lost.
// Source: Crassin 2010; Liu et al. 2010 (FreePipe); kplus_2015 §2.
// Buffers: updates counter; writes nodes.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    uint slot = atomicAdd(counter[p], 1u);
    if (slot < uint(SLOTS)) nodes[slot * pixels + p] = incoming();
    else atomicAdd(lost_fragments, 1u);
}

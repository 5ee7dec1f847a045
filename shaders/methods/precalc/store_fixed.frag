// Store of PreCalc_Fixed: the counter of the pixel gives each fragment a slot of the pixel's range.
// Invariant: slots 0 .. counter[p] - 1 of pixel p are written; a fragment beyond slot N - 1 is counted as lost.
// Source: sbuffer_2012 §4.
// Buffers: reads address; updates counter; writes nodes.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    uint slot = atomicAdd(counter[p], 1u);
    if (slot < uint(N)) nodes[address[p] + slot] = incoming();
    else atomicAdd(lost_fragments, 1u);
}

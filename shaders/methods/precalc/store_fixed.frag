// PreCalc_Fixed, store: the pixel's counter gives each fragment a slot of its range.
// Invariant: slots 0 .. counter[p]-1 of pixel p are written; a fragment beyond slot N-1 is lost, and counted.
// Source: sbuffer_2012 §4.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    uint slot = atomicAdd(counter[p], 1u);
    if (slot < uint(N)) nodes[address[p] + slot] = incoming();
    else atomicAdd(lost_fragments, 1u);
}

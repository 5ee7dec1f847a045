// Store: each fragment takes a cell of its own. DENSE: of as many cells for every pixel as the geometry has layers,
// neighbours side by side, by the pixel's counter, or with PLANES by the number of its primitive; else of the pixel's
// range, where the counter began at its first cell.
// Invariant: no pixel has more fragments than layers, or than were counted: every cell lies in the buffer. One that did
// not would be lost, and counted; llvmpipe stores faster behind this test than without one.
// Source: Crassin 2010 (dense); sbuffer_2012 §3.3 (ranges).
#include "scene/fragment.glsl"
#include "methods/adaptive/region.glsl"

void main() {
    if (rejected()) discard;
    uint p = place();
#if PLANES
    uint slot = quad;
#else
    uint slot = atomicAdd(counter[p], 1u);
#endif
#if DENSE
    slot = slot * PLACES + p;
#endif
    if (slot < capacity) nodes[slot] = incoming();
    else atomicAdd(lost_fragments, 1u);
}

// Store: each fragment takes a cell of its own. With DENSE every pixel has as many cells as the geometry has layers,
// and cells of neighbouring pixels are adjacent; the pixel's counter gives the layer, or with PLANES the number of the
// primitive does. Otherwise the cells are those of the pixel's range, and the counter starts at the first of them.
// Invariant: no pixel has more fragments than layers, or than were counted, so every cell is inside the buffer. The
// test for that would count a lost fragment; llvmpipe stores faster with this test than without it.
// Source: Crassin 2010 (dense); sbuffer_2012 §3.3 (ranges).
// Buffers: updates counter; writes nodes.
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

// Store: each fragment takes a cell of its own. With DENSE every pixel has as many cells as the geometry has layers,
// and cells of neighbouring pixels are adjacent, or each CHUNK cells of a pixel and then those of the next; the pixel's
// counter gives the layer, or with PLANES the number of the primitive does. Otherwise the cells are those of the pixel's range, and the counter starts at the first of them.
// Invariant: no pixel has more fragments than layers, or than were counted, so every cell is inside the buffer. The
// test for that would count a lost fragment; llvmpipe stores faster with this test than without it. With GUESSED the
// number of layers is a guess: a fragment without a cell is not stored, and whoever reads the counter tells of it.
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
    uint cell = (slot / uint(CHUNK) * PLACES + p) * uint(CHUNK) + slot % uint(CHUNK);
#else
    uint cell = slot;
#endif
    if (cell < capacity) nodes[cell] = incoming();
#if !GUESSED
    else atomicAdd(lost_fragments, 1u);
#endif
}

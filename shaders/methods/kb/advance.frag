// Step between two passes of the k-buffer: moves the boundary behind the fragments that were composited, and empties the
// slots of the pixel.
// Invariant: only pixels whose K slots were full pass, so that an occlusion count of zero ends the passes.
// Buffers: updates nodes, first_depth.
#include "common/pixel.glsl"
#include "methods/ps/slots.glsl"

void main() {
    uint p = pixel_index();
    uint furthest = read_slot(p, uint(K) - 1u).x;
    first_depth[p] = furthest == EMPTY ? EMPTY : furthest + 1u;
    for (uint slot = 0u; slot < uint(K); ++slot) write_slot(p, slot, FRAGMENT(EMPTY, 0u));
    if (furthest == EMPTY) discard;
}

// Second pass of the capture of a scene in several samples a pixel: stores depth bits, primitive and coverage mask of
// each fragment, for the pixels for which the host has reserved room in this round.
// Invariant: the fragments of pixel p are stored from first[p] on, in any order; first[p] is EMPTY if the pixel has no
// room in this round.
// Buffers: reads first; updates found; writes nodes, masks.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    if (first[p] == EMPTY) return;
    uint at = first[p] + atomicAdd(found[p], 1u);
    if (at < nodes_length) {
        FRAGMENT fragment = incoming();
        nodes[at] = uvec2(fragment.x, quad);
        masks[at] = payload_of(fragment) & ((1u << MASK_BITS) - 1u);
    } else {
        atomicAdd(lost_fragments, 1u);
    }
}

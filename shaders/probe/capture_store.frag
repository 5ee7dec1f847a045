// Second pass of the capture: stores depth bits and primitive of each fragment, for the pixels for which the host has
// reserved room in this round.
// Invariant: the fragments of pixel p are stored from first[p] on, in any order; first[p] is EMPTY if the pixel has no
// room in this round.
// Buffers: reads first; updates found; writes nodes.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    if (first[p] == EMPTY) return;
    uint at = first[p] + atomicAdd(found[p], 1u);
    if (at < nodes_length) nodes[at] = uvec2(incoming().x, quad);
    else atomicAdd(lost_fragments, 1u);
}

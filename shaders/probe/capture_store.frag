// Capture, second pass: depth bits and primitive of each fragment, where the host has made room for its pixel's.
// Invariant: a pixel's fragments stand from first[p] on, in any order; EMPTY: the pixel's turn is another time.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    if (first[p] == EMPTY) return;
    uint at = first[p] + atomicAdd(found[p], 1u);
    if (at < uint(nodes.length())) nodes[at] = uvec2(incoming().x, quad);
    else atomicAdd(lost_fragments, 1u);
}

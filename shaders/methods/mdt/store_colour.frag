// Second pass of the multi depth test: each fragment that is among the K nearest writes its colour into the slot of its
// depth.
// Invariant: colours[i] belongs to depths[i]. Fragments of equal depth collide in the first slot with that depth.
// Source: Maule et al. 2013; kplus_2015 §2.
// Buffers: reads depths; writes colours.
#include "scene/fragment.glsl"
#include "methods/mdt/key.glsl"

// The first of the K slots whose depth is at least `depth`, by halving the slots between which it lies; K if there is
// none.
uint first_slot(uint p, uint depth) {
    uint from = 0u, to = BOUND;
    while (from < to) {
        uint middle = (from + to) / 2u;
        if (depths[middle * pixels + p] < depth) from = middle + 1u;
        else to = middle;
    }
    return from;
}

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    uvec2 fragment = incoming();
    uint depth = depth_key(fragment.x);
#if CULLING_ON
    if (depth > depths[(BOUND - 1u) * pixels + p]) return;
#endif
    uint slot = first_slot(p, depth);
    if (slot < BOUND && depths[slot * pixels + p] == depth) colours[slot * pixels + p] = fragment.y;
}

// First pass of the multi depth test: a cascade of atomic minima leaves the K nearest depths in order.
// Invariant: no slot ever increases, and the value that a slot gives up moves on to the next slot. Equal depths pass
// each other and take one slot each. A depth behind the middle slot leaves all slots before it as they are; an outdated
// value of that slot is no less, and lets a depth start too early at worst.
// Source: Liu et al. 2010; Maule et al. 2013; kplus_2015 §2.
// Buffers: updates depths.
#include "scene/fragment.glsl"
#include "methods/mdt/key.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    uint depth = depth_key(incoming().x);
    uint first = 0u;
#if CULLING_ON
    if (depth >= depths[(BOUND - 1u) * pixels + p]) return;
    if (depth > depths[(BOUND / 2u) * pixels + p]) first = BOUND / 2u;
#endif
    for (uint slot = first; slot < BOUND && depth != EMPTY; ++slot)
        depth = max(depth, atomicMin(depths[slot * pixels + p], depth));
}

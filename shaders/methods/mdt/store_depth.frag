// First pass of the multi depth test: a cascade of atomic minima leaves the K nearest depths in order.
// Invariant: no slot ever increases, and the value that a slot gives up moves on to the next slot. Equal depths pass
// each other and take one slot each.
// Source: Liu et al. 2010; Maule et al. 2013; kplus_2015 §2.
// Buffers: updates depths.
#include "scene/fragment.glsl"
#include "methods/mdt/key.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    uint depth = depth_key(incoming().x);
#if CULLING_ON
    if (depth >= depths[(BOUND - 1u) * pixels + p]) return;
#endif
    for (uint slot = 0u; slot < BOUND && depth != EMPTY; ++slot)
        depth = max(depth, atomicMin(depths[slot * pixels + p], depth));
}

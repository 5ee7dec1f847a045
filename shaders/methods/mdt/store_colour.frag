// Second pass of the multi depth test: each fragment that is among the K nearest writes its colour into the slot of its
// depth.
// Invariant: colours[i] belongs to depths[i]. Fragments of equal depth collide in the first slot with that depth.
// Source: Maule et al. 2013; kplus_2015 §2.
// Buffers: reads depths; writes colours.
#include "scene/fragment.glsl"
#include "methods/mdt/key.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    uvec2 fragment = incoming();
    uint depth = depth_key(fragment.x);
#if CULLING_ON
    if (depth > depths[uint(K - 1) * pixels + p]) return;
#endif
    for (uint slot = 0u; slot < uint(K); ++slot) {
        if (depths[slot * pixels + p] == depth) {
            colours[slot * pixels + p] = fragment.y;
            break;
        }
    }
}

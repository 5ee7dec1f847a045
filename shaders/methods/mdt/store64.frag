// Multi depth test in one pass: a cascade of 64-bit atomic minima leaves the K nearest fragments in order. The high
// word is the depth, the low word the colour, so fragments of equal depth are ordered by colour.
// Invariant: no slot ever increases, and the value that a slot gives up moves on to the next slot. Equal fragments pass
// each other and take one slot each.
// Source: Kubisch 2014; kplus_2015 §2.
// Buffers: updates nodes.
#define BUFFER64 nodes
#include "scene/fragment.glsl"
#include "common/atomic64.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    uvec2 moving = incoming().yx, held;
    bool going = !IS_HELPER;
    for (uint slot = 0u; going && slot < BOUND && moving.y != EMPTY; ++slot) {
        going = atomic_min64(slot * pixels + p, moving, held);
        if (less64(moving, held)) moving = held;
    }
    if (!going) atomicAdd(lost_fragments, 1u);
}

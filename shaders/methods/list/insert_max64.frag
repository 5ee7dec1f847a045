// Sorted linked lists, store: 64-bit records (inverted depth, link) find their place by atomic max.
// Invariant: record[x] is the largest of the records inserted at x; what it displaces is inserted behind it.
// Source: gpupro5_ch1 §1.2.2-1.2.3, Listings 1.2 and 1.3.
#include "scene/fragment.glsl"
#include "common/helper.glsl"
#include "methods/list/alloc.glsl"

void main() {
    if (rejected()) discard;
    uint cell;
    if (!allocate(cell)) return;
    uvec2 fragment = incoming();
    payload[cell] = fragment.y;
    uint at = pixel_index();
    uint64_t record = packUint2x32(uvec2(pixels + cell, ~fragment.x));
    memoryBarrierBuffer();
    bool linked = IS_HELPER;
    for (uint tries = 0u; !linked && tries < uint(LOCK_TRIES); ++tries) {
        uint64_t old = atomicMax(records[at], record);
        linked = old == 0ul;
        at = unpackUint2x32(max(old, record)).x;
        record = min(old, record);
    }
    if (!linked) atomicAdd(lost_fragments, 1u);
}

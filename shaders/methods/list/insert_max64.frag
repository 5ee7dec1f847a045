// Store of sorted linked lists in 64-bit records (link, inverted depth): atomic maxima put each record into its place.
// Invariant: records[x] is the largest of the records inserted at x; the record that it displaces is inserted behind
// it.
// Source: gpupro5_ch1 §1.2.2-1.2.3, Listings 1.2 and 1.3.
// Buffers: reads payload; updates records; writes payload.
#define BUFFER64 records
#include "scene/fragment.glsl"
#include "common/atomic64.glsl"
#include "common/early_culling.glsl"
#include "methods/list/alloc.glsl"

// Walks past the nearer fragments, without writing; returns true as soon as they hide the fragment, so that a hidden
// fragment takes no cell.
bool hidden(uint depth, inout uint at) {
    float opacity = 0.0;
    uvec2 record;
    bool nearer = !IS_HELPER;
    for (uint tries = 0u; nearer && tries < uint(LOCK_TRIES); ++tries) {
        nearer = load_whole64(at, record) && record.y > ~depth && opacity < CULLING_OPACITY;
        if (nearer) {
            at = record.x;
            opacity = covered(opacity, payload[at - pixels]);
        }
    }
    COUNT(hidden, opacity >= CULLING_OPACITY)
    return opacity >= CULLING_OPACITY;
}

void main() {
    if (rejected()) discard;
    FRAGMENT fragment = incoming();
    uint p = pixel_index(), at = p, cell;
#if EARLY_CULLING_ON
    if (hidden(fragment.x, at)) return;
#endif
    if (!allocate(p, cell)) return;
    payload[cell] = payload_of(fragment);
    store64(pixels + cell, uvec2(0u));
    memoryBarrierBuffer();
    uvec2 record = uvec2(pixels + cell, ~fragment.x), old;
    bool linked = false, going = !IS_HELPER;
    for (uint tries = 0u; going && tries < uint(LOCK_TRIES); ++tries) {
        going = atomic_max64(at, record, old);
        linked = going && old == uvec2(0u);
        going = going && !linked;
        bool inserted = less64(old, record);
        at = inserted ? record.x : old.x;
        record = inserted ? old : record;
    }
    if (!linked) atomicAdd(lost_fragments, 1u);
}

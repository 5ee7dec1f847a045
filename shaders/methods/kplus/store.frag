// k+-buffer, store: keeps the K nearest fragments of the pixel, unsorted; the resolve sorts them.
// Invariant: counter[p] <= K slots are filled, slot 0 holds the furthest of them.
// Source: kplus_2015 §3.1-3.2, Alg. 1 and 2.
#include "scene/fragment.glsl"
#include "common/lock.glsl"
#include "methods/kplus/structure.glsl"

// A full buffer refuses what is no nearer than its furthest. Once full, slot 0 only comes nearer: an older value,
// read before the lock, lets a fragment through and never refuses one that belongs. Before that it moves away, so
// that it counts only after the counter: the barriers here and in `insert` keep that order.
bool refused(uint p, uint depth) {
    if (counter[p] < uint(K)) return false;
    memoryBarrierBuffer();
    return depth >= NODE(p, 0u).x;
}

void insert(uint p, uvec2 fragment) {
    uint count = counter[p];
    if (count < uint(K)) {
        insert_empty(p, count, fragment);
        memoryBarrierBuffer();
        counter[p] = count + 1u;
    } else if (fragment.x < NODE(p, 0u).x) {
        insert_full(p, fragment);
    }
}

void main() {
    uint p = pixel_index();
    uvec2 fragment = incoming();
    bool wanted = !rejected();
#if CULLING_ON
    wanted = wanted && !refused(p, fragment.x);
#endif
    CRITICAL_BEGIN(p, wanted)
    insert(p, fragment);
    CRITICAL_END(p)
}

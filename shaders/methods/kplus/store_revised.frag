// Revised k+-buffer, store: the first K-1 fragments take slots of their own without the lock.
// Invariant: a slot counts as taken only when its fragment can be seen; who needs the worst of them waits for all.
// Source: kplus_2015 §3.2.1, Alg. 2.
#include "scene/fragment.glsl"
#include "common/lock.glsl"
#include "methods/kplus/structure.glsl"

bool filled(uint p, FRAGMENT fragment) {
    uint slot = (atomicAdd(counter[p], 1u) & COUNTED) + 1u;
    if (slot >= uint(K)) return false;
    NODE(p, slot) = fragment;
    memoryBarrierBuffer();
    atomicAdd(counter[p], ONE_TAKEN);
    COUNT(entered, 1)
    return true;
}

// Ends because a fill waits for nothing.
bool fills_seen(uint p) {
    for (uint tries = 0u; tries < uint(LOCK_TRIES); ++tries)
        if ((atomicAdd(counter[p], 0u) >> COUNTED_BITS) + 1u >= uint(K)) return true;
    return false;
}

void main() {
    uint p = pixel_index();
    FRAGMENT fragment = incoming();
    bool wanted = !rejected() && !IS_HELPER;
    if (wanted) wanted = !filled(p, fragment);
#if CULLING_ON
    wanted = wanted && !refused(p, fragment);
#endif
    CRITICAL_BEGIN(p, wanted)
    if (fills_seen(p)) {
        memoryBarrierBuffer();
        insert(p, fragment);
    } else {
        atomicAdd(lost_fragments, 1u);
    }
    CRITICAL_END(p)
}

// Store of the revised k+-buffer: the first K - 1 fragments of a pixel take slots of their own without the lock; only
// the others enter the critical section.
// Invariant: a slot counts as taken only after its fragment is visible to other invocations. An invocation that needs
// the worst fragment waits until all K - 1 slots are taken.
// Limit: in a warp in lockstep the lanes that fill slots must meet the others again before the lock, or those would wait
// for lanes of their own warp until LOCK_TRIES, and lose fragments, counted. They meet at the end of the branch that
// fills, which has no return that a compiler could move behind the lock. Only a compiler that duplicated the lock for
// each side of that branch would part them; none is known to.
// Source: kplus_2015 §3.2.1, Alg. 2.
// Buffers: updates counter; writes nodes.
#include "scene/fragment.glsl"
#include "common/lock.glsl"
#define COUNTED_OUTSIDE 1
#include "methods/kplus/structure.glsl"

bool filled(uint p, FRAGMENT fragment) {
    uint slot = (atomicAdd(counter[p], 1u) & COUNTED) + 1u;
    bool fills = slot < BOUND;
    if (fills) {
        NODE(p, slot) = fragment;
        memoryBarrierBuffer();
        atomicAdd(counter[p], ONE_TAKEN);
        COUNT(entered, 1)
    }
    return fills;
}

// Terminates, because `filled` never blocks: every slot that was given out is filled after finitely many steps. The read
// before the loop spares the atomic where all slots are filled, as they mostly are. Without it the loop would be the
// first to access storage on every path: Mesa 26.0 and 26.1 (zink over lavapipe) keep what such a loop finds out about
// blocks for the lanes that leave it last alone, and crash in the next loop.
bool fills_seen(uint p) {
    if (taken(p) + 1u >= BOUND) return true;
    for (uint tries = 0u; tries < uint(LOCK_TRIES); ++tries)
        if ((atomicAdd(counter[p], 0u) >> COUNTED_BITS) + 1u >= BOUND) return true;
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

// Emulates 64-bit atomics: the pixel's lock in `lock64` protects the two words of an element of the buffer BUFFER64.
// Each element must be used by the fragments of one pixel only. `update64` returns false if it did nothing: the lock
// was not acquired in LOCK_TRIES tries, which the caller has to count as a loss, or this is a helper invocation.
// Invariant: operations on one element take effect one after the other; an invocation never holds two locks.
// Buffers: updates the buffer BUFFER64 and lock64.
#include "common/helper.glsl"
#include "common/less64.glsl"
#include "common/pixel.glsl"

const uint MAX64 = 0u, MIN64 = 1u, EXCHANGE64 = 2u;

uvec2 result64(uint operation, uvec2 held, uvec2 value) {
    if (operation == EXCHANGE64) return value;
    return less64(held, value) == (operation == MAX64) ? value : held;
}

// The lock is released inside the iteration that acquired it, because the lanes of a warp wait for each other, and by a
// plain store, as in common/lock.glsl.
bool update64(uint operation, uint at, uvec2 value, out uvec2 old) {
    uint p = pixel_index();
    bool waiting = !IS_HELPER;
    old = uvec2(0u);
    for (uint tries = 0u; waiting && tries < uint(LOCK_TRIES); ++tries) {
        if (atomicExchange(lock64[p], 1u) == 0u) {
            memoryBarrierBuffer();
            old = BUFFER64[at];
            BUFFER64[at] = result64(operation, old, value);
            memoryBarrierBuffer();
            lock64[p] = 0u;
            waiting = false;
        }
    }
    return !waiting && !IS_HELPER;
}

// Writes an element that no other invocation can access yet.
void store64(uint at, uvec2 value) {
    BUFFER64[at] = value;
}

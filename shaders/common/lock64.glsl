// Emulates 64-bit atomics: the pixel's lock in `wide_lock` guards the two words of an element of the buffer WIDE.
// Every element must be used by the fragments of one pixel only.
// False: nothing was done, because the lock was not had in LOCK_TRIES tries (the caller counts the loss), or
// because this is a helper invocation.
// Invariant: two operations on one element take effect one after the other; an invocation holds no second lock.
// Buffers: updates the buffer WIDE and wide_lock.
#include "common/helper.glsl"
#include "common/less64.glsl"
#include "common/pixel.glsl"

const uint MAX64 = 0u, MIN64 = 1u, EXCHANGE64 = 2u;

uvec2 result64(uint operation, uvec2 held, uvec2 value) {
    if (operation == EXCHANGE64) return value;
    return less64(held, value) == (operation == MAX64) ? value : held;
}

// The lock is released inside the iteration that took it: lanes of one warp wait for each other.
bool update64(uint operation, uint at, uvec2 value, out uvec2 old) {
    uint p = pixel_index();
    bool waiting = !IS_HELPER;
    old = uvec2(0u);
    for (uint tries = 0u; waiting && tries < uint(LOCK_TRIES); ++tries) {
        if (atomicExchange(wide_lock[p], 1u) == 0u) {
            memoryBarrierBuffer();
            old = WIDE[at];
            WIDE[at] = result64(operation, old, value);
            memoryBarrierBuffer();
            atomicExchange(wide_lock[p], 0u);
            waiting = false;
        }
    }
    return !waiting && !IS_HELPER;
}

// For an element that no other invocation knows of yet.
void store64(uint at, uvec2 value) {
    WIDE[at] = value;
}

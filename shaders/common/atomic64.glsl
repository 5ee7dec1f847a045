// 64-bit atomics on the buffer that WIDE names; values are (low word, high word), `old` is what stood there.
// ATOMIC64_NATIVE: the device's own. Otherwise the pixel's lock in `wide_lock` guards two words; then
// every element must be used by the fragments of one pixel only.
// False: nothing was done, because the lock was not had in LOCK_TRIES tries (the caller counts the loss), or
// because this is a helper invocation.
// Invariant: two operations on one element take effect one after the other; an invocation holds no second lock.
// Source: gpupro5_ch1 §1.6 emulates atomicMax the like, by compare-and-swap, which two words do not have.
#include "common/helper.glsl"
#include "common/less64.glsl"
#include "common/load64.glsl"
#include "common/pixel.glsl"

#if ATOMIC64_NATIVE

// For an element that no other invocation knows of yet.
void store64(uint at, uvec2 value) {
    WIDE[at] = packUint2x32(value);
}

// Both words of one moment, even while others write.
bool load_whole64(uint at, out uvec2 value) {
    value = load64(at);
    return !IS_HELPER;
}

bool atomic_max64(uint at, uvec2 value, out uvec2 old) {
    old = unpackUint2x32(atomicMax(WIDE[at], packUint2x32(value)));
    return !IS_HELPER;
}

bool atomic_min64(uint at, uvec2 value, out uvec2 old) {
    old = unpackUint2x32(atomicMin(WIDE[at], packUint2x32(value)));
    return !IS_HELPER;
}

bool exchange64(uint at, uvec2 value, out uvec2 old) {
    old = unpackUint2x32(atomicExchange(WIDE[at], packUint2x32(value)));
    return !IS_HELPER;
}

#else

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

void store64(uint at, uvec2 value) {
    WIDE[at] = value;
}

bool load_whole64(uint at, out uvec2 value) {
    return update64(MAX64, at, uvec2(0u), value);
}

bool atomic_max64(uint at, uvec2 value, out uvec2 old) {
    return update64(MAX64, at, value, old);
}

bool atomic_min64(uint at, uvec2 value, out uvec2 old) {
    return update64(MIN64, at, value, old);
}

bool exchange64(uint at, uvec2 value, out uvec2 old) {
    return update64(EXCHANGE64, at, value, old);
}

#endif

// 64-bit atomics on the buffer that the macro WIDE names. A value is (low word, high word); `old` receives the value
// that the element had before. With ATOMIC64_NATIVE the device's own atomics are used. Otherwise the pixel's lock in
// `wide_lock` protects the two words, and each element must be used by the fragments of one pixel only. The functions
// return false if they did nothing: the lock was not acquired in LOCK_TRIES tries, which the caller has to count as a
// loss, or this is a helper invocation.
// Invariant: operations on one element take effect one after the other; an invocation never holds two locks.
// Source: gpupro5_ch1 §1.6 also emulates atomicMax, but by a compare-and-swap, which does not exist for two words.
// Buffers: updates the buffer WIDE, and wide_lock if the atomics are emulated.
#include "common/helper.glsl"
#include "common/less64.glsl"
#include "common/load64.glsl"
#include "common/pixel.glsl"

#if ATOMIC64_NATIVE

// Writes an element that no other invocation can access yet.
void store64(uint at, uvec2 value) {
    WIDE[at] = packUint2x32(value);
}

// Reads both words of one value, even while other invocations write.
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

// The lock is released inside the iteration that acquired it, because the lanes of a warp wait for each other.
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

// 64-bit atomics on the buffer that the macro BUFFER64 names. A value is (low word, high word); `old` receives the
// value that the element had before. With ATOMIC64_NATIVE the device's own atomics are used on elements of type
// uint64_t; otherwise common/lock64.glsl emulates them. The functions return false if they did nothing: the lock was
// not acquired, which the caller has to count as a loss, or this is a helper invocation.
// Invariant: operations on one element take effect one after the other; an invocation never holds two locks.
// Source: gpupro5_ch1 §1.6 also emulates atomicMax, but by a compare-and-swap, which does not exist for two words.
// Buffers: updates the buffer BUFFER64.
#include "common/helper.glsl"
#include "common/less64.glsl"
#include "common/load64.glsl"

#if ATOMIC64_NATIVE

// Writes an element that no other invocation can access yet.
void store64(uint at, uvec2 value) {
    BUFFER64[at] = packUint2x32(value);
}

// Reads both words of one value, even while other invocations write: a plain load of 64 bits may be two accesses.
bool load_whole64(uint at, out uvec2 value) {
    value = unpackUint2x32(atomicMax(BUFFER64[at], packUint2x32(uvec2(0u))));
    return !IS_HELPER;
}

bool atomic_max64(uint at, uvec2 value, out uvec2 old) {
    old = unpackUint2x32(atomicMax(BUFFER64[at], packUint2x32(value)));
    return !IS_HELPER;
}

bool atomic_min64(uint at, uvec2 value, out uvec2 old) {
    old = unpackUint2x32(atomicMin(BUFFER64[at], packUint2x32(value)));
    return !IS_HELPER;
}

#else
#include "common/lock64.glsl"

bool load_whole64(uint at, out uvec2 value) {
    return update64(MAX64, at, uvec2(0u), value);
}

bool atomic_max64(uint at, uvec2 value, out uvec2 old) {
    return update64(MAX64, at, value, old);
}

bool atomic_min64(uint at, uvec2 value, out uvec2 old) {
    return update64(MIN64, at, value, old);
}

#endif

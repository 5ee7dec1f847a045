// 64-bit exchange on the buffer that BUFFER64 names; values are (low word, high word), `old` is what stood there.
// ATOMIC64_NATIVE: the device's own, on elements of type int64_t. GL_NV_shader_atomic_int64 has no exchange of
// uint64_t, and the bits of both are the same. Otherwise common/lock64.glsl emulates it.
// False: nothing was done, because the lock was not had, or because this is a helper invocation.
// Buffers: updates the buffer BUFFER64.
#include "common/helper.glsl"

#if ATOMIC64_NATIVE

// For an element that no other invocation knows of yet.
void store64(uint at, uvec2 value) {
    BUFFER64[at] = packInt2x32(ivec2(value));
}

bool exchange64(uint at, uvec2 value, out uvec2 old) {
    old = uvec2(unpackInt2x32(atomicExchange(BUFFER64[at], packInt2x32(ivec2(value)))));
    return !IS_HELPER;
}

#else
#include "common/lock64.glsl"

bool exchange64(uint at, uvec2 value, out uvec2 old) {
    return update64(EXCHANGE64, at, value, old);
}

#endif

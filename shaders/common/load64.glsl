// Reads an element of the buffer that the macro BUFFER64 names as (low word, high word), for native and emulated 64-bit
// atomics alike. While other invocations write, the two words may come from different values of the element.
// Buffers: reads the buffer BUFFER64.
uvec2 load64(uint at) {
#if ATOMIC64_NATIVE
    return unpackUint2x32(uint64_t(BUFFER64[at]));
#else
    return BUFFER64[at];
#endif
}

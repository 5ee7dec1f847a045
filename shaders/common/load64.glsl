// Reads an element of the buffer that WIDE names as (low word, high word), native or emulated alike.
// While other invocations write, the two words may be of different values; each of them is one that stood there.
uvec2 load64(uint at) {
#if ATOMIC64_NATIVE
    return unpackUint2x32(WIDE[at]);
#else
    return WIDE[at];
#endif
}

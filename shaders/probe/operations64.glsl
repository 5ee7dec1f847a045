// Applies each 64-bit atomic operation to an element of its own, and keeps what stood there, for invocation i. Both
// words of a value are 1 to INVOCATIONS, so that half a value shows.
// Buffers: updates words64 and signed64; writes before.
void apply(uint i) {
    uvec2 value = uvec2(i + 1u);
    before[i] = unpackUint2x32(atomicMax(words64[0], packUint2x32(value)));
    before[INVOCATIONS + i] = unpackUint2x32(atomicMin(words64[1], packUint2x32(value)));
    before[2u * INVOCATIONS + i] = uvec2(unpackInt2x32(atomicExchange(signed64[0], packInt2x32(ivec2(value)))));
}

// Trial of 64-bit atomics: every invocation applies each to an element of its own, and keeps what stood there.
// Both words of a value are 1 to INVOCATIONS, so that half a value shows.
// Buffers: updates wide and signed_wide; writes before.
layout(local_size_x = INVOCATIONS) in;

void main() {
    uint i = gl_LocalInvocationID.x;
    uvec2 value = uvec2(i + 1u);
    before[i] = unpackUint2x32(atomicMax(wide[0], packUint2x32(value)));
    before[INVOCATIONS + i] = unpackUint2x32(atomicMin(wide[1], packUint2x32(value)));
    before[2u * INVOCATIONS + i] = uvec2(unpackInt2x32(atomicExchange(signed_wide[0], packInt2x32(ivec2(value)))));
}

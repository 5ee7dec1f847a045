// Trial of atomic operations: every invocation applies each to an element of its own, and keeps what stood there.
// Values are 1 to INVOCATIONS; `or` sets bit i % 32.
// Buffers: updates element; writes before.
layout(local_size_x = INVOCATIONS) in;

void main() {
    uint i = gl_LocalInvocationID.x, value = i + 1u;
    before[i] = atomicAdd(element[0], 1u);
    before[INVOCATIONS + i] = atomicMax(element[1], value);
    before[2u * INVOCATIONS + i] = atomicMin(element[2], value);
    before[3u * INVOCATIONS + i] = atomicOr(element[3], 1u << (i % 32u));
    before[4u * INVOCATIONS + i] = atomicExchange(element[4], value);
    before[5u * INVOCATIONS + i] = atomicCompSwap(element[5], 0u, value);
}

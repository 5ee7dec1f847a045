// Applies each atomic operation to an element of its own, and keeps what stood there, for invocation i. Values are
// 1 to INVOCATIONS; `or` sets bit i % 32.
// Buffers: updates element and dedicated; writes before.
void apply(uint i) {
    uint value = i + 1u;
    before[i] = atomicAdd(element[0], 1u);
    before[INVOCATIONS + i] = atomicMax(element[1], value);
    before[2u * INVOCATIONS + i] = atomicMin(element[2], value);
    before[3u * INVOCATIONS + i] = atomicOr(element[3], 1u << (i % 32u));
    before[4u * INVOCATIONS + i] = atomicExchange(element[4], value);
    before[5u * INVOCATIONS + i] = atomicCompSwap(element[5], 0u, value);
    before[6u * INVOCATIONS + i] = atomicCounterIncrement(dedicated);
}

// Second step of the prefix sum in compute shaders: one work group scans the totals of all blocks, SCAN_BLOCK at a
// time.
// Invariant: afterwards block_sum[b] is the number of fragments before block b.
// Buffers: updates block_sum.
#include "methods/precalc/block_scan.glsl"

void main() {
    uint blocks = (pixels + uint(SCAN_BLOCK) - 1u) / uint(SCAN_BLOCK);
    uint before = 0u;
    for (uint start = 0u; start < blocks; start += uint(SCAN_BLOCK)) {
        uint first = start + gl_LocalInvocationIndex * uint(SCAN_RUN), own = 0u, total;
        uint end = min(first + uint(SCAN_RUN), blocks);
        for (uint b = first; b < end; ++b) own += block_sum[b];
        uint sum = before + sum_before(own, total);
        for (uint b = first; b < end; ++b) {
            uint next = sum + block_sum[b];
            block_sum[b] = sum;
            sum = next;
        }
        before += total;
        barrier();
    }
}

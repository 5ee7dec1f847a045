// Second step of the prefix sum in compute shaders: one work group scans the totals of all blocks, SCAN_BLOCK at a
// time.
// Invariant: afterwards block_sum[b] is the number of fragments before block b.
// Buffers: updates block_sum.
#include "methods/precalc/block_scan.glsl"

void main() {
    uint blocks = (pixels + uint(SCAN_BLOCK) - 1u) / uint(SCAN_BLOCK);
    uint before = 0u;
    for (uint start = 0u; start < blocks; start += uint(SCAN_BLOCK)) {
        uint lane = 2u * gl_LocalInvocationIndex;
        uint b = start + lane;
        block[lane] = b < blocks ? block_sum[b] : 0u;
        block[lane + 1u] = b + 1u < blocks ? block_sum[b + 1u] : 0u;
        uint total = exclusive_scan();
        if (b < blocks) block_sum[b] = before + block[lane];
        if (b + 1u < blocks) block_sum[b + 1u] = before + block[lane + 1u];
        before += total;
        barrier();
    }
}

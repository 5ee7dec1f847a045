// First step of the prefix sum in compute shaders: computes the prefix sum of each block of pixels by itself.
// Invariant: afterwards address[p] is the sum of the counters before p in its block; block_sum[b] is the total of block
// b.
// Buffers: reads counter; writes address, block_sum.
#include "methods/precalc/block_scan.glsl"

uint counted(uint p) {
    return p < pixels ? counter[p] : 0u;
}

void main() {
    uint blocks = (pixels + uint(SCAN_BLOCK) - 1u) / uint(SCAN_BLOCK);
    for (uint b = gl_WorkGroupID.x; b < blocks; b += gl_NumWorkGroups.x) {
        uint lane = 2u * gl_LocalInvocationIndex;
        uint p = b * uint(SCAN_BLOCK) + lane;
        block[lane] = counted(p);
        block[lane + 1u] = counted(p + 1u);
        uint total = exclusive_scan();
        if (p < pixels) address[p] = block[lane];
        if (p + 1u < pixels) address[p + 1u] = block[lane + 1u];
        if (lane == 0u) block_sum[b] = total;
        barrier();
    }
}

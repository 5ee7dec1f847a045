// Last step of the prefix sum in compute shaders: scans the counters of each block, behind the sum of all blocks before.
// Invariant: afterwards address[p] is the sum of all counters before p.
// Buffers: reads counter, block_sum; writes address.
#include "methods/precalc/counted.glsl"

void main() {
    for (uint b = gl_WorkGroupID.x; b * uint(SCAN_BLOCK) < pixels; b += gl_NumWorkGroups.x) {
        uint first = first_of(b), total;
        uint sum = block_sum[b] + sum_before(counted(first), total);
        for (uint p = first; p < min(first + uint(SCAN_RUN), pixels); ++p) {
            address[p] = sum;
            sum += counter[p];
        }
        barrier();
    }
}

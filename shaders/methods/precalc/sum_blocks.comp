// First step of the prefix sum in compute shaders: adds up the counters of each block of pixels.
// Invariant: afterwards block_sum[b] is the number of fragments of block b.
// Buffers: writes block_sum.
#include "methods/precalc/counted.glsl"

void main() {
    for (uint b = gl_WorkGroupID.x; b * uint(SCAN_BLOCK) < pixels; b += gl_NumWorkGroups.x) {
        uint total;
        sum_before(counted(first_of(b)), total);
        if (gl_LocalInvocationIndex == 0u) block_sum[b] = total;
        barrier();
    }
}

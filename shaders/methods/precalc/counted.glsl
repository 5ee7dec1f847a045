// Gives the run of pixels of this invocation, and how many fragments it has.
// Buffers: reads counter.
#include "methods/precalc/block_scan.glsl"

uint first_of(uint b) {
    return b * uint(SCAN_BLOCK) + gl_LocalInvocationIndex * uint(SCAN_RUN);
}

uint counted(uint first) {
    uint total = 0u;
    for (uint p = first; p < min(first + uint(SCAN_RUN), pixels); ++p) total += counter[p];
    return total;
}

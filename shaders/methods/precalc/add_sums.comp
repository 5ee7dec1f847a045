// Last step of the prefix sum in compute shaders: adds to each pixel the sum of all blocks before its own.
// Invariant: afterwards address[p] is the sum of all counters before p.
// Buffers: reads block_sum; updates address.
layout(local_size_x = SCAN_LANES) in;

void main() {
    uint step = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint p = gl_GlobalInvocationID.x; p < pixels; p += step) address[p] += block_sum[p / uint(SCAN_BLOCK)];
}

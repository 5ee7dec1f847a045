// Prefix sum by compute, last step: each pixel adds what lies before its block.
// Invariant: address[p] is the sum of all counters before p.
layout(local_size_x = SCAN_LANES) in;

void main() {
    uint step = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint p = gl_GlobalInvocationID.x; p < pixels; p += step) address[p] += block_sum[p / uint(SCAN_BLOCK)];
}

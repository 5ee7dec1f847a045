// Replaces one block in shared memory by its exclusive prefix sum and returns the total of the block.
// Source: Blelloch 1990, as in the parallel prefix sum that sbuffer_2012 §4 takes from OpenCL.
layout(local_size_x = SCAN_LANES) in;

shared uint block[SCAN_BLOCK];

uint exclusive_scan() {
    uint lane = gl_LocalInvocationIndex;
    for (uint reach = 1u; reach < uint(SCAN_BLOCK); reach *= 2u) {
        barrier();
        uint at = (lane + 1u) * 2u * reach - 1u;
        if (at < uint(SCAN_BLOCK)) block[at] += block[at - reach];
    }
    barrier();
    uint total = block[SCAN_BLOCK - 1];
    barrier();
    if (lane == 0u) block[SCAN_BLOCK - 1] = 0u;
    for (uint reach = uint(SCAN_BLOCK) / 2u; reach > 0u; reach /= 2u) {
        barrier();
        uint at = (lane + 1u) * 2u * reach - 1u;
        if (at < uint(SCAN_BLOCK)) {
            uint left = block[at - reach];
            block[at - reach] = block[at];
            block[at] += left;
        }
    }
    barrier();
    return total;
}

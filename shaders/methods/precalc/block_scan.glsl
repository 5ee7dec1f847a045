// Scans one block of SCAN_LANES runs of SCAN_RUN elements. Each invocation adds up a run by itself; the sums before the
// runs are found in shared memory.
// Source: Blelloch 1990, as in the parallel prefix sum that sbuffer_2012 §4 takes from OpenCL; the sums of runs are
// scanned as in Hillis and Steele 1986.
layout(local_size_x = SCAN_LANES) in;

shared uint run_sums[2 * SCAN_LANES];

// Returns the sum of `own` over the invocations before this one; `total` is the sum over all of them.
uint sum_before(uint own, out uint total) {
    uint lane = gl_LocalInvocationIndex, from = 0u, sum = own;
    run_sums[lane] = sum;
    for (uint reach = 1u; reach < uint(SCAN_LANES); reach *= 2u) {
        barrier();
        if (lane >= reach) sum += run_sums[from + lane - reach];
        from = uint(SCAN_LANES) - from;
        run_sums[from + lane] = sum;
    }
    barrier();
    total = run_sums[from + uint(SCAN_LANES) - 1u];
    return sum - own;
}

// Chooses the list that a fragment joins: the only list of its pixel, or one of BUCKETS lists, which divide the depth
// bounds of the pixel into equal ranges.
// Invariant: no fragment of a lower list is further than one of a higher list, because each step of the computation
// preserves the order of depths.
// Source: Vasilakis and Fudos 2013 (AB_LL-BUN), ranges as in bucket peeling, Liu et al. 2009; kplus_2015 §2.
// Buffers: reads nearest, furthest.
uint chosen_list(uint p, uint depth) {
#if BUCKETS > 1
    float near = uintBitsToFloat(nearest[p]), far = uintBitsToFloat(furthest[p]);
    float share = far > near ? (uintBitsToFloat(depth) - near) / (far - near) : 0.0;
    return min(uint(share * float(BUCKETS)), uint(BUCKETS - 1)) * pixels + p;
#else
    return p;
#endif
}

// The list that a fragment joins: its pixel's own, or of several by equal ranges of the pixel's depth bounds.
// Invariant: a fragment of a lower list is never further than one of a higher list, because each step of the
// arithmetic keeps the order of depths.
// Source: Vasilakis and Fudos 2013 (AB_LL-BUN), ranges as in bucket peeling, Liu et al. 2009; kplus_2015 §2.
uint chosen_list(uint p, uint depth) {
#if BUCKETS > 1
    float near = uintBitsToFloat(nearest[p]), far = uintBitsToFloat(furthest[p]);
    float share = far > near ? (uintBitsToFloat(depth) - near) / (far - near) : 0.0;
    return min(uint(share * float(BUCKETS)), uint(BUCKETS - 1)) * pixels + p;
#else
    return p;
#endif
}

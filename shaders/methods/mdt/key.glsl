// What the depth test compares: the bits of the float depth, in its order; or the papers' scaled conversion, which
// loses what is finer than DEPTH_BITS (kplus_2015 §2, §5.3).
uint depth_key(uint depth) {
#if KEY_FIXED
    return uint(uintBitsToFloat(depth) * float((1u << DEPTH_BITS) - 1u));
#else
    return depth;
#endif
}

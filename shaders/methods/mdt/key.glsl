// Computes the integer that the multi depth test compares. By default it is the bits of the float depth, which have the
// order of the depths. KEY_FIXED selects the papers' scaled conversion, which loses differences finer than DEPTH_BITS
// (kplus_2015 §2, §5.3); with 32 bits the scale is the largest float below 2^32.
// Invariant: no key equals EMPTY.
uint depth_key(uint depth) {
#if KEY_FIXED
#if DEPTH_BITS == 32
    const float scale = 4294967040.0;
#else
    const float scale = float((1u << DEPTH_BITS) - 1u);
#endif
    return uint(uintBitsToFloat(depth) * scale);
#else
    return depth;
#endif
}

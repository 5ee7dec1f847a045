// What the depth test compares: the bits of the float depth, in its order; or the papers' scaled conversion, which
// loses what is finer than DEPTH_BITS (kplus_2015 §2, §5.3). Of 32 bits the scale is the largest float that fits.
// Invariant: no key is EMPTY.
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

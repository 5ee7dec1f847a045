// The K slots of a pixel, depths and colours apart, with a code of both in the two bits that a depth in [0, 1]
// leaves free: a slot whose halves come from two fragments is found out three times in four, and reads as empty.
// A reconstruction: the code of Zhang 2014 is not public.
#include "common/hash.glsl"

const uint DEPTH_BITS = 0x3FFFFFFFu;

uint coded(uint depth, uint colour) {
    return depth | (mix_bits(depth ^ mix_bits(colour)) & ~DEPTH_BITS);
}

FRAGMENT read_slot(uint p, uint slot) {
    uint at = slot * pixels + p, code = depths[at], depth = code & DEPTH_BITS, colour = colours[at];
    return code != EMPTY && code == coded(depth, colour) ? FRAGMENT(depth, colour) : FRAGMENT(EMPTY, 0u);
}

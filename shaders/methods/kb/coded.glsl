// K slots per pixel with depths and colours in separate buffers. The two bits that a depth in [0, 1] leaves unused
// contain a code of depth and colour. A slot whose halves come from two different fragments is detected in three cases
// of four and then reads as empty.
// Source: a reconstruction; the code of Zhang 2014 is not public.
#include "common/hash.glsl"

const uint DEPTH_BITS = 0x3FFFFFFFu;

uint coded(uint depth, uint colour) {
    return depth | (mix_bits(depth ^ mix_bits(colour)) & ~DEPTH_BITS);
}

FRAGMENT decoded(uint code, uint colour) {
    uint depth = code & DEPTH_BITS;
    return code != EMPTY && code == coded(depth, colour) ? FRAGMENT(depth, colour) : FRAGMENT(EMPTY, 0u);
}

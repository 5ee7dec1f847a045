// Reads the sorted 64-bit elements of a pixel: depth in the high word, colour in the low one.
#define WIDE nodes
#include "common/load64.glsl"

uvec2 slot_fragment(uint at) {
    return load64(at).yx;
}

#include "common/sorted_slots.glsl"

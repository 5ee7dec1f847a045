// Reads the sorted depths and colours of a pixel.
uvec2 slot_fragment(uint at) {
    return uvec2(depths[at], colours[at]);
}

#include "common/sorted_slots.glsl"

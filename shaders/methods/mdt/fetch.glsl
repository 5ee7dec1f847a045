// Reads the sorted depths of a pixel together with their colours.
// Buffers: reads depths, colours.
uvec2 slot_fragment(uint at) {
    return uvec2(depths[at], colours[at]);
}

#include "common/sorted_slots.glsl"

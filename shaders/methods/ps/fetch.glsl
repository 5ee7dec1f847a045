// Reads the sorted fragments of a pixel.
uvec2 slot_fragment(uint at) {
    return nodes[at];
}

#include "common/sorted_slots.glsl"

// Reads the sorted fragments of a pixel.
FRAGMENT slot_fragment(uint at) {
    return nodes[at];
}

#include "common/sorted_slots.glsl"

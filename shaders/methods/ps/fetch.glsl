// Reads the sorted slots of a pixel.
// Buffers: reads nodes.
FRAGMENT slot_fragment(uint at) {
    return nodes[at];
}

#include "common/sorted_slots.glsl"

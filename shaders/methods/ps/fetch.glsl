// Reads the sorted slots of a pixel.
// Buffers: reads nodes.
FRAGMENT slot_fragment(uint at) {
    return nodes_at(at);
}

#include "common/sorted_slots.glsl"

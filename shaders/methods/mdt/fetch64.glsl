// Reads the sorted 64-bit elements of a pixel; the high word is the depth, the low word the colour.
// Buffers: reads nodes.
uvec2 slot_fragment(uint at) {
    return nodes_at(at).yx;
}

#include "common/sorted_slots.glsl"

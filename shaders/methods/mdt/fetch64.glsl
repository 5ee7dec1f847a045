// Reads the sorted 64-bit elements of a pixel; the high word is the depth, the low word the colour.
// Buffers: reads nodes.
#define BUFFER64 nodes
#include "common/load64.glsl"

uvec2 slot_fragment(uint at) {
    return load64(at).yx;
}

#include "common/sorted_slots.glsl"

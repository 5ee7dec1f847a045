// Reads the sorted depths of a pixel together with their colours. Of slots with one depth only the first has a colour.
// Buffers: reads depths, colours.
uvec2 slot_fragment(uint at) {
    uint depth = depths_at(at);
    bool repeated = at >= pixels && depths_at(at - pixels) == depth;
    return uvec2(depth, repeated ? 0u : colours_at(at));
}

#include "common/sorted_slots.glsl"

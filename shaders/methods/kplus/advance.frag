// Step between two iterations of the multi-pass k+-buffer: moves the boundary behind the fragments that were
// composited, and empties the k+-buffer of the pixel.
// Invariant: only pixels whose K slots were full pass, so that an occlusion count of zero ends the peeling.
// Source: kplus_2015 §4.3.
// Buffers: updates nodes, last, repeats; writes counter.
#include "common/pixel.glsl"
#include "methods/kplus/slots.glsl"

uint equal_to(uint p, uvec2 fragment) {
    uint found = 0u;
    for (uint slot = 0u; slot < BOUND; ++slot) found += uint(NODE(p, slot) == fragment);
    return found;
}

void main() {
    uint p = pixel_index();
    bool full = taken(p) == BOUND;
    uvec2 furthest = full ? NODE(p, 0u) : uvec2(EMPTY);
    if (full) repeats[p] = (furthest == last[p] ? repeats[p] : 0u) + equal_to(p, furthest);
    last[p] = furthest;
    counter[p] = 0u;
    NODE(p, 0u) = uvec2(EMPTY);
    if (!full) discard;
}

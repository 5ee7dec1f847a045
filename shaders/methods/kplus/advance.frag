// Multi-pass k+-buffer, between iterations: moves the boundary behind what was composited, and empties the pixel.
// Invariant: a pixel passes only where its K slots were full, so that a count of zero ends the peeling.
// Source: kplus_2015 §4.3.
#include "common/pixel.glsl"
#include "methods/kplus/slots.glsl"

uint equal_to(uint p, uvec2 fragment) {
    uint found = 0u;
    for (uint slot = 0u; slot < uint(K); ++slot) found += uint(NODE(p, slot) == fragment);
    return found;
}

void main() {
    uint p = pixel_index();
    bool full = taken(p) == uint(K);
    uvec2 furthest = full ? NODE(p, 0u) : uvec2(EMPTY);
    if (full) repeats[p] = (furthest == last[p] ? repeats[p] : 0u) + equal_to(p, furthest);
    last[p] = furthest;
    counter[p] = 0u;
    NODE(p, 0u) = uvec2(EMPTY);
    if (!full) discard;
}

// Empties the k+-buffer of each pixel, for a frame that reuses the ranges and counts of an earlier frame.
// Invariant: afterwards no slot is taken, and the first cell of each range is empty, as after the referencing pass.
// Buffers: updates counter; writes nodes.
#include "common/pixel.glsl"
#include "common/payload.glsl"
#include "methods/kplus/slots.glsl"

void main() {
    uint p = pixel_index();
    FIND_CELLS(p)
    counter[p] &= COUNTED;
    if (ROOM(p) > 0u) NODE(p, 0u) = NO_FRAGMENT;
}

// Empties the k+-buffer of each pixel, whose range and count of fragments stand from an earlier frame.
// Invariant: afterwards no slot is taken, and the first cell of each range is empty, as the referencing leaves them.
#include "common/pixel.glsl"
#include "common/payload.glsl"
#include "methods/kplus/slots.glsl"

void main() {
    uint p = pixel_index();
    counter[p] &= COUNTED;
    if (ROOM(p) > 0u) NODE(p, 0u) = NO_FRAGMENT;
}

// One of the log2(pixels) full-screen steps of the prefix sum over all pixels.
// Invariant: before step i, each element is the sum of the 2^i seeds that end at its pixel.
// Source: Peeper 2008, after sbuffer_2012 §2; the step is that of Hillis and Steele 1986.
// Buffers: reads address_previous; writes address.
#include "common/pixel.glsl"

uniform uint iteration;

void main() {
    uint p = pixel_index();
    uint reach = 1u << iteration;
    address[p] = address_previous[p] + (p >= reach ? address_previous[p - reach] : 0u);
}

// Prefix sum over all pixels, one of log2(pixels) full-screen steps.
// Invariant: before step i each element is the sum of the 2^i seeds that end at its pixel.
// Source: Peeper 2008, after sbuffer_2012 §2; the step is that of Hillis and Steele 1986.
#include "common/pixel.glsl"

uniform uint iteration;

void main() {
    uint p = pixel_index();
    uint reach = 1u << iteration;
    address[p] = address_previous[p] + (p >= reach ? address_previous[p - reach] : 0u);
}

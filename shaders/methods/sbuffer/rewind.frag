// Takes the address of each pixel, which the store of the frame before moved to the end of its range, back to the first.
// Invariant: afterwards the range of a non-empty pixel is [address, address + counter).
#include "common/pixel.glsl"

void main() {
    uint p = pixel_index();
    if (counter[p] > 0u) address[p] -= counter[p];
}

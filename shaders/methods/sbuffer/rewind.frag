// Moves the address of each pixel from the end of its range, where the store of the previous frame has left it, back to
// the first cell.
// Invariant: afterwards the range of a pixel with fragments is [address, address + counter).
// Buffers: reads counter; updates address.
#include "common/pixel.glsl"

void main() {
    uint p = pixel_index();
    if (counter[p] > 0u) address[p] -= counter[p];
}

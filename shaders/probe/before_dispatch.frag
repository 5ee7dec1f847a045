// Trial of uniform blocks: stores by a draw, with a uniform block and a storage block.
// Buffers: writes drawn.
#include "common/pixel.glsl"

void main() {
    drawn[pixel_index()] = pixels;
}

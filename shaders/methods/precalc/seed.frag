// Start of the full-screen prefix sum: gives each pixel the counter of the pixel before it, so that the inclusive sums
// of the following steps are the exclusive sums of the counters.
// Buffers: reads counter; writes address.
#include "common/pixel.glsl"

void main() {
    uint p = pixel_index();
    address[p] = p > 0u ? counter[p - 1u] : 0u;
}

// Prefix sum over all pixels, start: each pixel holds the counter of the one before it, so that the
// inclusive sums below are the exclusive sums of the counters.
#include "common/pixel.glsl"

void main() {
    uint p = pixel_index();
    address[p] = p > 0u ? counter[p - 1u] : 0u;
}

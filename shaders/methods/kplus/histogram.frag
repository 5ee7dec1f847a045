// Depth-complexity histogram: histogram[i] is the number of pixels with i + 1 fragments, the last bin also of
// those with more. Source: kplus_2015 §4.2, Alg. 3, lines 12-16.
#include "common/pixel.glsl"

void main() {
    uint count = min(counter[pixel_index()], uint(histogram.length()));
    if (count > 0u) atomicAdd(histogram[count - 1u], 1u);
}

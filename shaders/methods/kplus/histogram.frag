// Depth-complexity histogram: counts the pixels that have i + 1 fragments in histogram[i], and those with more
// fragments than bins in the last bin.
// Source: kplus_2015 §4.2, Alg. 3, lines 12-16.
// Buffers: reads counter; updates histogram.
#include "common/pixel.glsl"

void main() {
    uint count = min(counter[pixel_index()], histogram_length);
    if (count > 0u) atomicAdd(histogram[count - 1u], 1u);
}

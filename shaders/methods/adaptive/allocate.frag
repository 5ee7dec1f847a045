// Allocate: each pixel that has fragments takes a range with exactly as many cells, by one atomic on the shared counter
// `taken`. With CLASSED the pixel is also classified by its number of fragments. `deepest` keeps the most of them.
// Invariant: the ranges [counter, counter + number of fragments) of the pixels do not overlap and leave no gap.
// Buffers: updates taken, deepest; writes counter.
#if CLASSED
#include "methods/adaptive/classify.glsl"
#endif
#include "methods/adaptive/region.glsl"
#include "methods/adaptive/fragment_count.glsl"

void main() {
    uint count = fragment_count();
#if CLASSED
    classify(count);
#endif
    if (count > 0u) counter[place()] = atomicAdd(taken[0], count);
    if (count > deepest[0]) atomicMax(deepest[0], count);
}

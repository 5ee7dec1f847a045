// Allocate: each pixel with fragments takes a range of exactly as many cells; CLASSED, it is classified by their number.
// Invariant: the ranges [counter, counter + tally) do not overlap and leave no gap.
#if CLASSED
#include "methods/adaptive/classify.glsl"
#endif
#include "methods/adaptive/region.glsl"
#include "methods/adaptive/tally.glsl"

void main() {
    uint count = tallied();
#if CLASSED
    classify(count);
#endif
    if (count > 0u) counter[place()] = atomicAdd(taken[0], count);
}

// Allocate: each pixel with fragments takes a range of exactly as many cells; CLASSED, the class of their number as
// depth: class i holds at most 2^(i+1) of them, the first three are one.
// Invariant: the ranges [counter, counter + tally) do not overlap and leave no gap.
#include "common/pixel_class.glsl"
#include "methods/adaptive/region.glsl"
#include "methods/adaptive/tally.glsl"

void main() {
    uint count = tallied();
#if CLASSED
    gl_FragDepth = CLASS_DEPTH(count == 0u ? NO_CLASS : count <= 4u ? 1 : count <= 32u ? findMSB(count - 1u) : 5);
#endif
    if (count > 0u) counter[place()] = atomicAdd(taken[0], count);
}

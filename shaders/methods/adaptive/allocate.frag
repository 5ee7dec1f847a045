// Allocate: each pixel with fragments takes a range of exactly as many cells; CLASSED, the class of their number as
// depth: class i holds at most 2^(i+1) of them, the first four are one, and the last has no bound.
// Invariant: the ranges [counter, counter + tally) do not overlap and leave no gap.
#include "common/pixel_class.glsl"
#include "methods/adaptive/region.glsl"
#include "methods/adaptive/tally.glsl"

void main() {
    uint count = tallied();
#if CLASSED
    int index = count == 0u ? NO_CLASS : count <= 16u ? 3 : count <= 64u ? findMSB(count - 1u) : 6;
    gl_FragDepth = CLASS_DEPTH(index);
    if (count > 0u && draws[5 * index] == 0u) {
        draws[5 * index] = 3u;
        draws[5 * index + 1] = 1u;
    }
#endif
    if (count > 0u) counter[place()] = atomicAdd(taken[0], count);
}

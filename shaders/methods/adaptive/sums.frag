// Sums of the count: the fragments of each SEGMENT pixels of a row, from which the host takes bands that fit a budget.
#include "methods/adaptive/tally.glsl"

void main() {
    uvec2 xy = uvec2(gl_FragCoord.xy);
    uint count = tallied(), segments = (width + uint(SEGMENT) - 1u) / uint(SEGMENT);
    if (count > 0u) atomicAdd(sums[xy.y * segments + xy.x / uint(SEGMENT)], count);
}

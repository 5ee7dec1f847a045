// Sums the fragments of each SEGMENT adjacent pixels of a row. From these sums the host chooses bands that fit a memory
// budget.
// Buffers: updates sums.
#include "methods/adaptive/fragment_count.glsl"

void main() {
    uvec2 xy = uvec2(gl_FragCoord.xy);
    uint count = fragment_count(), segments = (width + uint(SEGMENT) - 1u) / uint(SEGMENT);
    if (count > 0u) atomicAdd(sums[xy.y * segments + xy.x / uint(SEGMENT)], count);
}

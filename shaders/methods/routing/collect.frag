// Collects the samples of one stencil-routing pass: appends them to the array of the pixel, which has SLOTS cells. Where
// it has a cell for each of the pixel's N fragments, one that finds none is lost.
// Invariant: resume[p] is the first primitive that is not captured yet, or EMPTY if all are; a pass that leaves a
// sample empty has processed every fragment. Only pixels whose samples are all used pass, so that an occlusion count of
// zero ends the passes.
// Buffers: updates counter; writes nodes, resume.
#include "common/pixel.glsl"

void main() {
    uint p = pixel_index();
    ivec2 xy = ivec2(gl_FragCoord.xy);
    uint count = counter[p];
    for (int s = 0; s < SAMPLES; ++s) {
        uint depth = texelFetch(depths, xy, s).x;
        if (depth == EMPTY) break;
        if (count < uint(SLOTS)) nodes[count++ * pixels + p] = uvec2(depth, texelFetch(colours, xy, s).x);
        else if (SLOTS == N) atomicAdd(lost_fragments, 1u);
    }
    counter[p] = count;
    bool all_taken = texelFetch(depths, xy, SAMPLES - 1).x != EMPTY;
    resume[p] = all_taken ? texelFetch(arrivals, xy, SAMPLES - 1).x + 1u : EMPTY;
    if (!all_taken) discard;
}

// Occupancy map, last step: writes the end of the K-th occupied interval as the depth of the pixel, or 1 if fewer
// intervals are occupied. The store pass then discards fragments beyond this depth.
// Invariant: at least K fragments, if there are as many, are not beyond this depth (the paper's k_a-th fragment, k_a >=
// k).
// Source: occupancy_2015, step 3.
// Buffers: reads occupied.
#include "common/pixel.glsl"
#include "common/occupancy/interval.glsl"

void main() {
    uint p = pixel_index();
    uint wanted = uint(K);
    gl_FragDepth = 1.0;
    for (uint word = 0u; word < uint(OCCUPANCY / 32); ++word) {
        uint bits = occupied[word * pixels + p];
        uint found = uint(bitCount(bits));
        if (found < wanted) {
            wanted -= found;
            continue;
        }
        for (; wanted > 1u; --wanted) bits &= bits - 1u;
        gl_FragDepth = interval_end(word * 32u + uint(findLSB(bits)), texelFetch(bounds, ivec2(gl_FragCoord.xy), 0).xy);
        break;
    }
}

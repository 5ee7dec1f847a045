// Occupancy map: sets one bit for each interval of the pixel's depth range that contains a fragment.
// Invariant: interval_of never decreases with depth, so the intervals are ordered like the depths.
// Source: occupancy_2015, step 2; Liu et al. 2009.
// Buffers: updates occupied.
#include "scene/fragment.glsl"
#include "common/occupancy/interval.glsl"

void main() {
    if (rejected()) discard;
    uint interval = interval_of(gl_FragCoord.z, texelFetch(bounds, ivec2(gl_FragCoord.xy), 0).xy);
    atomicOr(occupied[(interval / 32u) * pixels + pixel_index()], 1u << (interval % 32u));
}

// The incoming fragment of a geometry pass: (depth bits, payload), and whether it was generated at all.
// The order of the bits of a float is the order of the float, because depth >= 0.
#include "common/pixel.glsl"
#include "common/hash.glsl"
#include "common/payload.glsl"

flat in uint quad;
flat in uint payload8;

FRAGMENT incoming() {
    return fragment_of(floatBitsToUint(gl_FragCoord.z), payload_from(payload8));
}

#if LEAST
// Whether the quad is among those that its pixel draws: LEAST to QUADS of them, a run of the order of submission
// (kplus_2015 §5.1.1: up to n = 10 k fragments influence a pixel). The hash is that of mfr_bench/scene/quads.py.
bool drawn(uint p) {
    uint layers = uint(LEAST) + hash3(p, 0xFFFFFFFFu, seed) % uint(QUADS - LEAST + 1);
    return (hash3(p, 0xFFFFFFFEu, seed) % uint(QUADS) + quad) % uint(QUADS) < layers;
}
#endif

// Fragment probability f_p (kplus_2015 §5.1.1), decided per pixel, quad and seed. With CULLS also beyond the K-th
// depth of the occupancy map, where the pass has a depth test of its own and early z cannot see to it.
bool rejected() {
#if CULLS
    if (gl_FragCoord.z > texelFetch(kth_depth, ivec2(gl_FragCoord.xy), 0).x) return true;
#endif
#if LEAST
    if (!drawn(pixel_index())) return true;
#endif
#if REJECTS
    return hash3(pixel_index(), quad, seed) >= keep_threshold;
#else
    return false;
#endif
}

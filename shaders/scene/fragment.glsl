// The incoming fragment of a geometry pass, (depth bits, payload), and the test that rejects fragments which the scene
// does not generate. The bits of a non-negative float, read as an integer, have the order of the float.
#include "common/pixel.glsl"
#include "common/hash.glsl"
#include "common/payload.glsl"

flat in uint quad;
flat in uint payload8;

FRAGMENT incoming() {
    return fragment_of(floatBitsToUint(gl_FragCoord.z), payload_from(payload8));
}

#if LEAST
// Tells whether the quad is among those that its pixel draws: between LEAST and QUADS of them, consecutive in order of
// submission (kplus_2015 §5.1.1: up to n = 10 k fragments influence a pixel). mfr_bench/scene/quads.py does the same.
bool drawn(uint p) {
    uint layers = uint(LEAST) + hash3(p, 0xFFFFFFFFu, seed) % uint(QUADS - LEAST + 1);
    return (hash3(p, 0xFFFFFFFEu, seed) % uint(QUADS) + quad) % uint(QUADS) < layers;
}
#endif

// Fragment probability f_p (kplus_2015 §5.1.1), decided by pixel, quad and seed. With CULLS the test also rejects
// fragments beyond the K-th depth of the occupancy map, for passes whose own depth test keeps early z from doing so;
// with OCCLUDED it rejects fragments at or behind the depth of the scene's opaque triangles.
bool rejected() {
#if OCCLUDED
    if (gl_FragCoord.z >= texelFetch(opaque_depth, ivec2(gl_FragCoord.xy), 0).x) return true;
#endif
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

// Reads the colour of a fragment with a coverage mask. Its payload is a word of parts, as mfr_bench/effects/coverage.py
// makes it: the mask, a bit for each sample, and red, green, blue and opacity with straight alpha.
#include "effects/fragment.glsl"

// Premultiplied.
vec4 shade_of(FRAGMENT fragment) {
    const uint shades = (1u << SHADE_BITS) - 1u;
    const uvec4 bits = uint(MASK_BITS) + uint(SHADE_BITS) * uvec4(0u, 1u, 2u, 3u);
    vec4 shade = vec4(uvec4(word_of(fragment)) >> bits & shades) / float(shades);
    return vec4(shade.rgb * shade.a, shade.a);
}

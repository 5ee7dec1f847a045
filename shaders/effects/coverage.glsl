// Resolves the samples of a pixel.
// COVERAGE_SAMPLES: each sample composites the fragments that cover it, and the pixel is the mean of its samples.
// COVERAGE_ALPHA: a fragment's opacity is multiplied by the share of the samples that it covers.
// COVERAGE_IGNORED: a fragment counts as if it covered the whole pixel, so that two triangles count twice at an edge
// which they share: the wire frame.
#include "effects/shade.glsl"

uint mask_of(FRAGMENT fragment) {
    return word_of(fragment) & ((1u << MSAA) - 1u);
}

#if COVERAGE_SAMPLES
vec4 samples_so_far[MSAA];  // with transmittance

vec4 effect_begin() {
    for (int i = 0; i < MSAA; ++i) samples_so_far[i] = NOTHING;
    return vec4(0.0);
}

vec4 effect_add(vec4 state, FRAGMENT fragment) {
    vec4 shade = shade_of(fragment);
    uint mask = mask_of(fragment);
    for (int i = 0; i < MSAA; ++i) {
        if ((mask >> i & 1u) != 0u) samples_so_far[i] = behind_of(samples_so_far[i], shade);
    }
    return state;
}

vec4 effect_end(vec4 state) {
    vec4 sum = vec4(0.0);
    for (int i = 0; i < MSAA; ++i) sum += with_opacity(samples_so_far[i]);
    return sum / float(MSAA);
}
#else
vec4 effect_begin() {
    return NOTHING;
}

vec4 effect_add(vec4 state, FRAGMENT fragment) {
    vec4 shade = shade_of(fragment);
#if COVERAGE_ALPHA
    shade *= float(bitCount(mask_of(fragment))) / float(MSAA);
#endif
    return behind_of(state, shade);
}

vec4 effect_end(vec4 state) {
    return with_opacity(state);
}
#endif

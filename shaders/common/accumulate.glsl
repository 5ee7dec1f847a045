// Defines the colour that a resolve accumulates front to back: start with `colour = nothing_yet()`, call `colour =
// onto(colour, layer)` for each fragment, and end with `composited(colour)`. By default the accumulator is float32 and
// keeps the transmittance. ACCUMULATE_FLOAT16 and ACCUMULATE_UNORM8 round it after each fragment, as blending into a
// target of that format would. ACCUMULATE_COMPENSATED carries the rounding errors of the additions along, so that the
// error does not grow with the number of fragments.
// Source: compensated summation, Kahan 1965.
#include "common/colour.glsl"
#include "common/transmittance.glsl"

#if ACCUMULATE_FLOAT16 || ACCUMULATE_UNORM8

vec4 nothing_yet() {
    return vec4(0.0);
}

vec4 onto(vec4 front, vec4 layer) {
    vec4 colour = under(front, layer);
#if ACCUMULATE_FLOAT16
    return vec4(unpackHalf2x16(packHalf2x16(colour.rg)), unpackHalf2x16(packHalf2x16(colour.ba)));
#else
    return unpackUnorm4x8(packUnorm4x8(colour));
#endif
}

vec4 composited(vec4 colour) {
    return colour;
}

float opacity_so_far(vec4 colour) {
    return colour.a;
}

#else

vec3 excess;  // the accumulated colour minus the exact sum of what was added to it

vec4 nothing_yet() {
    excess = vec3(0.0);
    return NOTHING;
}

vec4 onto(vec4 front, vec4 layer) {
#if ACCUMULATE_COMPENSATED
    precise vec3 added = front.a * layer.rgb - excess;
    precise vec3 colour = front.rgb + added;
    precise vec3 rounded = (colour - front.rgb) - added;
    excess = rounded;
    return vec4(colour, front.a * (1.0 - layer.a));
#else
    return behind_of(front, layer);
#endif
}

vec4 composited(vec4 colour) {
    return with_opacity(colour);
}

float opacity_so_far(vec4 colour) {
    return 1.0 - colour.a;
}

#endif

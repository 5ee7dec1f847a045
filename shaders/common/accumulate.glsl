// The colour to which a resolve adds fragments, front to back: `colour = nothing_yet()`, then
// `colour = onto(colour, behind)` for each. Rounded after each fragment as a target of 16-bit floats or of 8 bits would
// round it; or with what the additions round away carried along, so that rounding does not grow with their number.
// Source: compensated summation, Kahan 1965.
#include "common/colour.glsl"

#if ACCUMULATE_COMPENSATED

vec4 excess;  // of the colour over the sum of what was added to it

vec4 nothing_yet() {
    excess = vec4(0.0);
    return vec4(0.0);
}

vec4 onto(vec4 front, vec4 behind) {
    precise vec4 added = ((1.0 - front.a) + excess.a) * behind - excess;
    precise vec4 colour = front + added;
    precise vec4 rounded = (colour - front) - added;
    excess = rounded;
    return colour;
}

#else

vec4 nothing_yet() {
    return vec4(0.0);
}

vec4 onto(vec4 front, vec4 behind) {
    vec4 colour = under(front, behind);
#if ACCUMULATE_FLOAT16
    return vec4(unpackHalf2x16(packHalf2x16(colour.rg)), unpackHalf2x16(packHalf2x16(colour.ba)));
#elif ACCUMULATE_UNORM8
    return unpackUnorm4x8(packUnorm4x8(colour));
#else
    return colour;
#endif
}

#endif

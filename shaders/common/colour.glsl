// Converts stored colours for arithmetic: stored colours have straight alpha, colours in arithmetic are premultiplied
// floats.
#include "common/payload.glsl"

vec4 premultiplied(PAYLOAD payload) {
    vec4 colour = straight(payload);
    return vec4(colour.rgb * colour.a, colour.a);
}

vec4 colour_of(FRAGMENT fragment) {
    return premultiplied(payload_of(fragment));
}

// Front-to-back compositing: places `behind` under `front` (Porter and Duff 1984).
vec4 under(vec4 front, vec4 behind) {
    return front + (1.0 - front.a) * behind;
}

// Colours have straight alpha in storage, premultiplied float in arithmetic.
#include "common/payload.glsl"

vec4 premultiplied(PAYLOAD payload) {
    vec4 colour = straight(payload);
    return vec4(colour.rgb * colour.a, colour.a);
}

vec4 colour_of(FRAGMENT fragment) {
    return premultiplied(payload_of(fragment));
}

// Front-to-back compositing: what lies behind shows through what is there (Porter and Duff 1984).
vec4 under(vec4 front, vec4 behind) {
    return front + (1.0 - front.a) * behind;
}

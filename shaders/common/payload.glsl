// A stored fragment: x holds its depth bits, y (and z) its payload, in one of three formats.
// rgba8: four 8-bit channels with straight alpha.
// rgba16f: four 16-bit floats with straight alpha, in units of 1/255. A half represents whole numbers up to 2048
// exactly, so an 8-bit colour is restored bit for bit and the error is that of rgba8; in units of 1, or premultiplied,
// rounding to halves would cost up to 2^-12 = 2.4e-4 per channel.
// two_channel: one byte of luminance and one byte of the blend between two base colours, both gamma 2 encoded light,
// one unused byte, and one byte of alpha (gpupro5_ch2 §2.3, Listing 2.1). A decoded channel may exceed 1.
#if PAYLOAD_RGBA16F

PAYLOAD payload_from(uint rgba8) {
    vec4 colour = vec4(rgba8 & 255u, rgba8 >> 8 & 255u, rgba8 >> 16 & 255u, rgba8 >> 24);
    return PAYLOAD(packHalf2x16(colour.rg), packHalf2x16(colour.ba));
}

vec4 straight(PAYLOAD payload) {
    return vec4(unpackHalf2x16(payload.x), unpackHalf2x16(payload.y)) / 255.0;
}

FRAGMENT fragment_of(uint depth, PAYLOAD payload) {
    return FRAGMENT(depth, payload.x, payload.y);
}

PAYLOAD payload_of(FRAGMENT fragment) {
    return PAYLOAD(fragment.y, fragment.z);
}

bool payload_beyond(FRAGMENT a, FRAGMENT b) {
    return a.y > b.y || (a.y == b.y && a.z > b.z);
}

// The bits of a half have the order of the half, because alpha >= 0.
uint ordered_alpha(FRAGMENT fragment) {
    return fragment.z >> 16;
}

#else

PAYLOAD payload_from(uint word) {
    return word;
}

vec4 straight(PAYLOAD payload) {
    vec4 stored = unpackUnorm4x8(payload);
#if PAYLOAD_TWO_CHANNEL
    vec3 colour = mix(base_a.rgb, base_b.rgb, stored.g);
    float luminance = dot(colour, vec3(0.2126, 0.7152, 0.0722));
    stored.rgb = stored.r * sqrt(colour / luminance);
#endif
    return stored;
}

FRAGMENT fragment_of(uint depth, PAYLOAD payload) {
    return FRAGMENT(depth, payload);
}

PAYLOAD payload_of(FRAGMENT fragment) {
    return fragment.y;
}

bool payload_beyond(FRAGMENT a, FRAGMENT b) {
    return a.y > b.y;
}

uint ordered_alpha(FRAGMENT fragment) {
    return fragment.y >> 24;
}

#endif

#define FIRST_FRAGMENT fragment_of(0u, PAYLOAD(0u))  // precedes every other fragment
#define NO_FRAGMENT fragment_of(EMPTY, PAYLOAD(0u))  // follows every other fragment, and has no colour

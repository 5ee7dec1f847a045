// Colours are RGBA8 with straight alpha in storage, premultiplied float in arithmetic.
vec4 premultiplied(uint rgba8) {
    vec4 colour = unpackUnorm4x8(rgba8);
    return vec4(colour.rgb * colour.a, colour.a);
}

// Front-to-back compositing: what lies behind shows through what is there (Porter and Duff 1984).
vec4 under(vec4 front, vec4 behind) {
    return front + (1.0 - front.a) * behind;
}

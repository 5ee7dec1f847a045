// Reads what an effect wants to know of a fragment beside its depth bits.
vec4 payload_colour(FRAGMENT fragment) {
    return straight(payload_of(fragment));
}

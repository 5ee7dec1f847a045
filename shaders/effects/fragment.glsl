// Reads what an effect wants to know of a fragment. For effects on objects a payload is no colour but a word of parts,
// as mfr_bench/effects/word.py makes it: from the lowest bit 5 of the object's number, 1 for the front of a face, 6 each
// of red, green and blue, 8 of opacity.
float depth_of(FRAGMENT fragment) {
    return uintBitsToFloat(fragment.x);
}

vec4 payload_colour(FRAGMENT fragment) {
    return straight(payload_of(fragment));
}

uint word_of(FRAGMENT fragment) {
#if PAYLOAD_RGBA16F
    return packUnorm4x8(straight(payload_of(fragment)));
#else
    return payload_of(fragment);
#endif
}

uint object_of(FRAGMENT fragment) {
    return 1u << (word_of(fragment) & 31u);
}

bool is_front(FRAGMENT fragment) {
    return (word_of(fragment) & 32u) != 0u;
}

vec3 face_colour(FRAGMENT fragment) {
    return vec3(uvec3(word_of(fragment)) >> uvec3(6u, 12u, 18u) & 63u) / 63.0;
}

float face_opacity(FRAGMENT fragment) {
    return float(word_of(fragment) >> 24) / 255.0;
}

// The objects, a bit for each, that a ray is inside of behind a face, when it was inside of these before it.
uint inside_after(uint objects, FRAGMENT fragment) {
    uint object = object_of(fragment);
    return is_front(fragment) ? objects | object : objects & ~object;
}

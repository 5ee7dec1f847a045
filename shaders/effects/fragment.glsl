// Reads what an effect wants to know of a fragment. For effects on objects a payload is no colour but a word of parts,
// as mfr_bench/effects/word.py makes it: the object's number, a bit for the front of a face, red, green and blue, and
// opacity. mfr_bench/effects/numbers.py has the bits of each.
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
    return 1u << (word_of(fragment) & ((1u << OBJECT_BITS) - 1u));
}

bool is_front(FRAGMENT fragment) {
    return (word_of(fragment) >> FRONT_BIT & 1u) != 0u;
}

vec3 face_colour(FRAGMENT fragment) {
    const uint steps = (1u << COLOUR_BITS) - 1u;
    return vec3(uvec3(word_of(fragment)) >> uvec3(RED_BIT, GREEN_BIT, BLUE_BIT) & steps) / float(steps);
}

float face_opacity(FRAGMENT fragment) {
    return float(word_of(fragment) >> OPACITY_BIT) / 255.0;
}

// The objects, a bit for each, that a ray is inside of behind a face, when it was inside of these before it.
uint inside_after(uint objects, FRAGMENT fragment) {
    uint object = object_of(fragment);
    return is_front(fragment) ? objects | object : objects & ~object;
}

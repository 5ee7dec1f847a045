// Shows the EFFECT_LAYER-th fragment of a pixel alone, opaque. With EFFECT_LAYER 0 it is an x-ray view: grey grows with
// the light that is taken, of which every fragment takes a tenth, whatever its colour.
uint seen;

vec4 effect_begin() {
    seen = 0u;
    return vec4(0.0);
}

vec4 effect_add(vec4 state, FRAGMENT fragment) {
    ++seen;
    return seen == uint(EFFECT_LAYER) ? vec4(payload_colour(fragment).rgb, 1.0) : state;
}

vec4 effect_end(vec4 state) {
#if EFFECT_LAYER == 0
    return seen == 0u ? vec4(0.0) : vec4(vec3(1.0 - pow(LET_THROUGH, float(seen))), 1.0);
#else
    return state;
#endif
}

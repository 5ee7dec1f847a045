// Constructive solid geometry: shows the face where a ray first enters the union, the intersection or the difference of
// A, the object 0, and B, all other objects together. EFFECT_OPERATION is 0, 1 or 2 for the three.
uint inside;

vec4 effect_begin() {
    inside = 0u;
    return vec4(0.0);
}

bool within_solid(uint objects) {
    bool a = (objects & 1u) != 0u, b = (objects & ~1u) != 0u;
#if EFFECT_OPERATION == 0
    return a || b;
#elif EFFECT_OPERATION == 1
    return a && b;
#else
    return a && !b;
#endif
}

// The state is the colour of the face, once it was found.
vec4 effect_add(vec4 state, FRAGMENT fragment) {
    bool before = within_solid(inside);
    inside = inside_after(inside, fragment);
    bool enters = state.a == 0.0 && !before && within_solid(inside);
    return enters ? vec4(face_colour(fragment), 1.0) : state;
}

vec4 effect_end(vec4 state) {
    return state;
}

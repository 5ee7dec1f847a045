// Shows what closed objects leave of white light from behind. Along a length d within an object of colour c and opacity
// a, a channel is multiplied by exp(-EFFECT_ABSORPTION * a * (1 - c) * d): the law of Beer and Lambert.
vec3 medium, optical;
float depth_before;

vec4 effect_begin() {
    medium = optical = vec3(0.0);
    depth_before = 0.0;
    return vec4(0.0);
}

// The state's last number is 1 once there was any fragment.
vec4 effect_add(vec4 state, FRAGMENT fragment) {
    float depth = depth_of(fragment);
    optical += max(medium, 0.0) * (depth - depth_before);
    vec3 of_face = float(EFFECT_ABSORPTION) * face_opacity(fragment) * (1.0 - face_colour(fragment));
    medium += is_front(fragment) ? of_face : -of_face;
    depth_before = depth;
    return vec4(1.0);
}

vec4 effect_end(vec4 state) {
    return vec4(exp(-optical), 1.0) * state.a;
}

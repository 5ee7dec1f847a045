// Shows how much of a ray lies within at least one closed object, in window depth, as grey.
int inside;
float length_inside, depth_before;

vec4 effect_begin() {
    inside = 0;
    length_inside = depth_before = 0.0;
    return vec4(0.0);
}

// The state's last number is 1 once there was any fragment.
vec4 effect_add(vec4 state, FRAGMENT fragment) {
    float depth = depth_of(fragment);
    if (inside > 0) length_inside += depth - depth_before;
    inside += is_front(fragment) ? 1 : -1;
    depth_before = depth;
    return vec4(1.0);
}

vec4 effect_end(vec4 state) {
    return vec4(vec3(min(length_inside, 1.0)), 1.0) * state.a;
}

// Shows where the insides of two or more closed objects overlap along a ray: red is 1, green the length of depth in
// which they do, blue the number of intervals in sixteenths. Other pixels with a fragment are grey.
uint inside, intervals;
float began, length_of_overlap;

vec4 effect_begin() {
    inside = intervals = 0u;
    began = length_of_overlap = 0.0;
    return vec4(0.0);
}

// The state's last number is 1 once there was any fragment.
vec4 effect_add(vec4 state, FRAGMENT fragment) {
    float depth = depth_of(fragment);
    bool before = bitCount(inside) > 1;
    inside = inside_after(inside, fragment);
    bool now = bitCount(inside) > 1;
    if (before && !now && depth > began) {
        length_of_overlap += depth - began;
        ++intervals;
    }
    if (now && !before) began = depth;
    return vec4(1.0);
}

vec4 effect_end(vec4 state) {
    vec3 overlap = vec3(1.0, min(length_of_overlap, 1.0), float(min(intervals, uint(MOST_SHOWN))) / float(MOST_SHOWN));
    return vec4(intervals > 0u ? overlap : vec3(GREY), 1.0) * state.a;
}

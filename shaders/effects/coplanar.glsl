// Shows where fragments of a pixel share a depth. Red is the share of the pixel's fragments that do, green is the
// largest group of one depth in sixteenths, and opacity is 1 where the pixel has any fragment.
uint seen, group, shared_depth, largest, depth_before;

vec4 effect_begin() {
    seen = group = shared_depth = largest = 0u;
    depth_before = EMPTY;
    return vec4(0.0);
}

vec4 effect_add(vec4 state, FRAGMENT fragment) {
    ++seen;
    group = fragment.x == depth_before ? group + 1u : 1u;
    if (group > 1u) {
        shared_depth += group == 2u ? 2u : 1u;
        largest = max(largest, group);
    }
    depth_before = fragment.x;
    return state;
}

vec4 effect_end(vec4 state) {
    if (seen == 0u) return vec4(0.0);
    float group_shown = float(min(largest, uint(MOST_SHOWN))) / float(MOST_SHOWN);
    return vec4(float(shared_depth) / float(seen), group_shown, 0.0, 1.0);
}

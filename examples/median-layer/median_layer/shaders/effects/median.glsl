// Shows the middle fragment of a pixel alone, opaque; of an even number of fragments the nearer of the two.
// How many there are is known only at the end, so that the colours of all are kept until then.
vec3 median_colours[N];
uint median_count;

vec4 effect_begin() {
    median_count = 0u;
    return vec4(0.0);
}

vec4 effect_add(vec4 state, FRAGMENT fragment) {
    if (median_count < uint(N)) median_colours[median_count++] = payload_colour(fragment).rgb;
    return state;
}

vec4 effect_end(vec4 state) {
    return median_count == 0u ? state : vec4(median_colours[(median_count - 1u) / 2u], 1.0);
}

// Resolve of hybrid transparency: composites the core exactly, and behind it the weighted average of the tail.
// Buffers: reads tail_count, tail.
#include "common/composite_sorted.glsl"

// Composites as many layers of the mean colour and the mean opacity as there are fragments (Bavoil and Myers 2008).
vec4 average(vec4 sum, float count) {
    if (sum.a == 0.0) return vec4(0.0);
    float opacity = 1.0 - pow(max(0.0, 1.0 - sum.a / count), count);
    return vec4(sum.rgb / sum.a * opacity, opacity);
}

vec4 resolve_pixel(uint p) {
    vec4 core = composite_sorted(p);
    return tail_count[p] == 0u ? core : under(core, average(tail[p], float(tail_count[p])));
}

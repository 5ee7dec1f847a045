// Resolve of fragments that already come nearest first.
#include "common/composite_sorted.glsl"

vec4 resolve_pixel(uint p) {
    return composite_sorted(p);
}

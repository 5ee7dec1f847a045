// Resolves a pixel whose fragments the method's fetch already returns nearest first.
#include "common/composite_sorted.glsl"

vec4 resolve_pixel(uint p) {
    return composite_sorted(p);
}

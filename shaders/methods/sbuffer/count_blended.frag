// Counts the fragments of each pixel by additive blending: every fragment adds one to the float of its pixel.
// Invariant: the sum is exact, because a float holds every whole number up to 2^24.
// Source: sbuffer_2012 §3.1 (ADD blending into R_32F).
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    out_counted = vec4(1.0, 0.0, 0.0, 0.0);
}

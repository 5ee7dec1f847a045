// Count by blending: one unit of a 16-bit channel per fragment, where an atomic per fragment costs three times as much.
// Invariant: afterwards the channel is exactly the number of fragments, up to 65,535.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    out_tally = vec4(1.0 / float(DEEPEST));
}

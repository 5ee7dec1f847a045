// Count by blending: each fragment adds one unit to a 16-bit channel. An atomic per fragment would cost three times as
// much.
// Invariant: after the pass the channel is exactly the number of fragments of the pixel, up to 65,535.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    out_fragment_counts = vec4(1.0 / float(DEEPEST));
}

// Count: each fragment increments the counter of its pixel (sbuffer_2012 §3.1).
// Invariant: after the pass, counter[p] is the number of fragments of pixel p.
// Buffers: updates counter.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    atomicAdd(counter[pixel_index()], 1u);
}

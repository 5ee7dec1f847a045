// Count: one increment per fragment into the pixel's counter (sbuffer_2012 §3.1).
// Invariant: afterwards counter[p] is the number of fragments of pixel p.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    atomicAdd(counter[pixel_index()], 1u);
}

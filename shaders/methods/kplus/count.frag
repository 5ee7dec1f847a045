// Bounded count: each fragment increments the counter of its pixel, until the counter is K.
// Invariant: min(f, K) fragments of each pixel pass. Concurrent tests may increment a counter beyond K; the referencing
// pass limits it to K again.
// Source: kplus_2015 §4.1, Alg. 3, lines 5-11.
// Buffers: updates counter.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    if (counter[p] >= uint(K) || atomicAdd(counter[p], 1u) >= uint(K)) discard;
}

// Bounded count: one increment per fragment, until the pixel has K.
// Invariant: the fragments that pass are min(f, K) of each pixel; tests at one time may carry a counter beyond K,
// which the referencing pass takes back.
// Source: kplus_2015 §4.1, Alg. 3, lines 5-11.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    if (counter[p] >= uint(K) || atomicAdd(counter[p], 1u) >= uint(K)) discard;
}

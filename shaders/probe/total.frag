// Self-test of atomics: every fragment adds one to the same word.
// Buffers: updates total.
#include "scene/fragment.glsl"

void main() {
    atomicAdd(total[0], 1u);
}

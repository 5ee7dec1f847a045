// Self-test of atomics: every fragment adds one to a single word.
#include "scene/fragment.glsl"

void main() {
    atomicAdd(total[0], 1u);
}

// Counts the fragments that are blended where none is stored. Runs outside timed frames.
#include "scene/fragment.glsl"

void main() {
    if (!rejected()) atomicAdd(stored_fragments, 1u);
}

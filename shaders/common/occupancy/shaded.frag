// Counts the fragments that early z lets through to the store pass. Runs outside timed frames.
#include "scene/fragment.glsl"

void main() {
    if (!rejected()) atomicAdd(shaded_fragments, 1u);
}

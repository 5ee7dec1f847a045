// Counts the fragments that early z lets through to the store pass. This pass runs outside timed frames.
#include "scene/fragment.glsl"

void main() {
    if (!rejected()) atomicAdd(shaded_fragments, 1u);
}

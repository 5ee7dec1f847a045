// Counts the fragments that are blended directly, in frames that store none. This pass runs outside timed frames.
#include "scene/fragment.glsl"

void main() {
    if (!rejected()) atomicAdd(stored_fragments, 1u);
}

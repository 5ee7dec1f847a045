// Stores the fragments of one pixel, each at the number of its primitive.
// Invariant: every primitive has one fragment in the pixel, so every cell is written once.
// Buffers: writes nodes.
#include "scene/fragment.glsl"

void main() {
    if (quad < capacity) nodes[quad] = incoming();
    else atomicAdd(lost_fragments, 1u);
}

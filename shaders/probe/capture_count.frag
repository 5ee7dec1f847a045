// First pass of the capture: counts the fragments of each pixel.
// Buffers: updates found.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    atomicAdd(found[pixel_index()], 1u);
}

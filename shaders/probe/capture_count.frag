// Capture, first pass: the fragments of each pixel, counted.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    atomicAdd(found[pixel_index()], 1u);
}

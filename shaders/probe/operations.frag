// Trial of atomic operations in fragment shaders: the first INVOCATIONS pixels apply them.
// Buffers: updates element and dedicated; writes before.
#include "common/pixel.glsl"
#include "probe/operations.glsl"

void main() {
    uint p = pixel_index();
    if (p < INVOCATIONS) apply(p);
}

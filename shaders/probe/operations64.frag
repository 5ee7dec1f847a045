// Trial of 64-bit atomics in fragment shaders: the first INVOCATIONS pixels apply them.
// Buffers: updates words64 and signed64; writes before.
#include "common/pixel.glsl"
#include "probe/operations64.glsl"

void main() {
    uint p = pixel_index();
    if (p < INVOCATIONS) apply(p);
}

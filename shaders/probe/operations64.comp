// Trial of 64-bit atomics in compute shaders: one group applies them.
// Buffers: updates words64 and signed64; writes before.
#include "probe/operations64.glsl"

layout(local_size_x = INVOCATIONS) in;

void main() {
    apply(gl_LocalInvocationID.x);
}

// Trial of 64-bit atomics in compute shaders: one group applies them.
// Buffers: updates wide and signed_wide; writes before.
#include "probe/operations64.glsl"

layout(local_size_x = INVOCATIONS) in;

void main() {
    apply(gl_LocalInvocationID.x);
}

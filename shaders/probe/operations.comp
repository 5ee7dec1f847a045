// Trial of atomic operations in compute shaders: one group applies them.
// Buffers: updates element and dedicated; writes before.
#include "probe/operations.glsl"

layout(local_size_x = INVOCATIONS) in;

void main() {
    apply(gl_LocalInvocationID.x);
}

// Draws triangles whose corners are given in clip space, three vertices for each.
// Invariant: a pixel gets the same depth in every pass, whatever the shaders of the pass do.
#include "scene/primitive.glsl"

in vec4 in_corner;  // clip space

invariant gl_Position;
flat out uint quad;
flat out uint payload8;

void main() {
    quad = uint(gl_VertexID) / 3u;
    payload8 = PRIMITIVE_WORD;
    gl_Position = in_corner;
}

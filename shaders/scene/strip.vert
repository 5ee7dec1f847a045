// Draws slanted primitives as strips of two triangles, four vertices for each, whose corners are given in clip space.
// Invariant: a pixel gets the same depth in every pass, whatever the shaders of the pass do. Primitives that share
// corners have identical numbers there, so that no pixel along the common edge is covered twice.
#include "scene/primitive.glsl"

in vec4 in_corner;  // clip space

invariant gl_Position;
flat out uint quad;
flat out uint payload8;

void main() {
    quad = uint(gl_VertexID) / 4u;
    payload8 = PRIMITIVE_WORD;
    gl_Position = in_corner;
}

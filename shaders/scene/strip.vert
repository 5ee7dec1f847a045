// Draws one slanted primitive per instance, as a strip of four corners.
// Invariant: a pixel gets the same depth in every pass, whatever the shaders of the pass do. Primitives that share
// corners have identical numbers there, so that no pixel along the common edge is covered twice.
#include "scene/primitive.glsl"

in vec4 in_corner0;  // clip space
in vec4 in_corner1;
in vec4 in_corner2;
in vec4 in_corner3;

invariant gl_Position;
flat out uint quad;
flat out uint payload8;

void main() {
    quad = uint(gl_InstanceID);
    payload8 = PRIMITIVE_WORD;
    if (gl_VertexID == 0) gl_Position = in_corner0;
    else if (gl_VertexID == 1) gl_Position = in_corner1;
    else if (gl_VertexID == 2) gl_Position = in_corner2;
    else gl_Position = in_corner3;
}

// Draws triangles whose window depths fall from 1 at the nearest to 0, three vertices for each, with clip depths from 0
// to w. The fragment shaders of such a scene read a depth as MIRRORED_DEPTH, which grows from the eye.
// Invariant: a pixel gets the same depth in every pass, whatever the shaders of the pass do.
#include "scene/primitive.glsl"

in vec4 in_corner;  // clip space

uniform bool clips_from_zero;

invariant gl_Position;
flat out uint quad;
flat out uint payload8;

void main() {
    quad = uint(gl_VertexID) / 3u;
    payload8 = PRIMITIVE_WORD;
    gl_Position = clips_from_zero ? in_corner : vec4(in_corner.xy, 2.0 * in_corner.z - in_corner.w, in_corner.w);
}

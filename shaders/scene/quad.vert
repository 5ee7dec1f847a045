// Draws one pixel-aligned quad per instance, as a strip of four vertices.
// Invariant: the depth reaches window space bit for bit, and alike in every program: any float from 2^-126 on if the
// device clips depths from 0 to 1, otherwise floats on a 2^-23 grid.
#include "scene/primitive.glsl"

in ivec4 in_rect;   // x0 y0 x1 y1, half-open pixels
in float in_depth;  // window space

uniform bool clips_from_zero;

invariant gl_Position;
flat out uint quad;
flat out uint payload8;

void main() {
    vec2 pixel = vec2((gl_VertexID & 1) == 0 ? in_rect.x : in_rect.z, (gl_VertexID & 2) == 0 ? in_rect.y : in_rect.w);
    quad = uint(gl_InstanceID);
    payload8 = PRIMITIVE_WORD;
    gl_Position = vec4(2.0 * pixel / vec2(width, height) - 1.0,
                       clips_from_zero ? in_depth : 2.0 * in_depth - 1.0, 1.0);
}

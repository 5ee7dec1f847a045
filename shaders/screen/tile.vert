// A square over each listed tile, for a class of pixels at its depth.
#include "common/pixel_class.glsl"
in uint in_tile;

void main() {
    uint columns = (width + uint(TILE) - 1u) / uint(TILE);
    uvec2 corner = uvec2(in_tile % columns, in_tile / columns) + uvec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(2.0 * vec2(uint(TILE) * corner) / vec2(width, height) - 1.0, 0.0, 1.0);
#ifdef CLASS
    gl_Position.z = 2.0 * CLASS_DEPTH(CLASS) - 1.0;
#endif
}

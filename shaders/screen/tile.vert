// Draws one point over each listed tile, at the depth of a class of pixels if CLASS is defined. Points are used because
// a square of two triangles would shade the pixels along their common edge twice. The viewport must consist of whole
// tiles.
#include "common/pixel_class.glsl"
in uint in_tile;

void main() {
    uvec2 tiles = (uvec2(width, height) + uint(TILE) - 1u) / uint(TILE);
    vec2 middle = vec2(in_tile % tiles.x, in_tile / tiles.x) + 0.5;
    gl_PointSize = float(TILE);
    gl_Position = vec4(2.0 * middle / vec2(tiles) - 1.0, 0.0, 1.0);
#ifdef CLASS
    gl_Position.z = 2.0 * CLASS_DEPTH(CLASS) - 1.0;
#endif
}

// Resolve of every pixel, of the listed tiles or of one class of pixels, in a compute shader: work groups shade square
// tiles.
// Invariant: every pixel inside the viewport is written by at most one invocation.
#include "common/colour.glsl"
#include "common/pixel_class.glsl"
#include <fetch>
#include <resolver>
#include "common/resolve_lists.glsl"

layout(local_size_x = TILE, local_size_y = TILE) in;

bool mine(uvec2 xy) {
    if (xy.x >= width || xy.y >= height) return false;
#if CLASSED
    return texelFetch(pixel_class, ivec2(xy), 0).x == CLASS_DEPTH(CLASS);
#else
    return true;
#endif
}

void main() {
    uvec2 tiles = (uvec2(width, height) + uint(TILE) - 1u) / uint(TILE);
#if BY_TILE
    for (uint at = gl_WorkGroupID.x; at < tile_command[1]; at += gl_NumWorkGroups.x) {
        uint tile = tile_list[at];
#else
    for (uint tile = gl_WorkGroupID.x; tile < tiles.x * tiles.y; tile += gl_NumWorkGroups.x) {
#endif
        uvec2 xy = uint(TILE) * uvec2(tile % tiles.x, tile / tiles.x) + gl_LocalInvocationID.xy;
        if (mine(xy)) imageStore(out_image, ivec2(xy), resolve_lists(xy.y * width + xy.x));
    }
}

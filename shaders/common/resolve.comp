// Resolve as a compute shader, for all pixels, the pixels of the region, the listed tiles, or the pixels of one class.
// A work group shades one square tile after another.
// Invariant: every pixel of the extent is written by at most one invocation; no pixel outside it is read or written.
// Buffers: reads tile_command, tile_list.
#include "common/extent.glsl"
#include "common/colour.glsl"
#include "common/pixel_class.glsl"
#include <fetch>
#include <resolver>
#include "common/resolve_lists.glsl"

layout(local_size_x = TILE, local_size_y = TILE) in;

bool mine(uvec2 xy) {
    if (!in_extent(xy)) return false;
#if CLASSED
    return texelFetch(pixel_class, ivec2(xy), 0).x == CLASS_DEPTH(CLASS);
#else
    return true;
#endif
}

void main() {
#if BY_TILE
    uint columns = (width + uint(TILE) - 1u) / uint(TILE);
    for (uint at = gl_WorkGroupID.x; at < tile_command[0]; at += gl_NumWorkGroups.x) {
        uvec2 tile = uvec2(tile_list[at] % columns, tile_list[at] / columns);
#else
    uvec2 tiles = tiles_in_extent();
    for (uint number = gl_WorkGroupID.x; number < tiles.x * tiles.y; number += gl_NumWorkGroups.x) {
        uvec2 tile = tile_in_extent(number);
#endif
        uvec2 xy = uint(TILE) * tile + gl_LocalInvocationID.xy;
        if (mine(xy)) imageStore(out_image, ivec2(xy), resolve_lists(xy.y * width + xy.x));
    }
}

// Resolve as a compute shader: a work group orders a tile, and each of its pixels composites its fragments in that
// order.
// Invariant: every pixel of the extent is written by one invocation; no pixel outside it is read or written.
#include "common/extent.glsl"
#include <fetch>
#include <resolver>
#include "methods/coherent/order.glsl"
#include "methods/coherent/window.glsl"

layout(local_size_x = TILE, local_size_y = TILE) in;

void main() {
    uvec2 tiles = tiles_in_extent();
    for (uint number = gl_WorkGroupID.x; number < tiles.x * tiles.y; number += gl_NumWorkGroups.x) {
        uvec2 first = uint(TILE) * tile_in_extent(number), xy = first + gl_LocalInvocationID.xy;
        uint p = xy.y * width + xy.x, count = 0u;
        if (in_extent(xy)) count = FETCH_COUNT(p);
        uint ordered = share_order(count, first);
        if (in_extent(xy)) imageStore(out_image, ivec2(xy), resolve_in_order(p, count, ordered));
        barrier();
    }
}

// Lists the square tiles that contain a pixel with fragments. Each invocation examines the pixels of one tile until it
// finds a pixel with a fragment. The pass also writes the indirect commands that draw one point, or dispatch one work
// group, for each listed tile.
// Invariant: a tile is listed exactly once if any of its pixels has a fragment, otherwise never; no pixel outside the
// region is read.
// Buffers: updates tile_command; writes tile_list.
#include "common/extent.glsl"
#include <fetch>

layout(local_size_x = LISTERS) in;

bool has_fragments(uint p) {
#ifdef FETCH_COUNT
    return FETCH_COUNT(p) > 0u;
#else
    FRAGMENT fragment;
    fetch_begin(p);
    return fetch_next(fragment);
#endif
}

bool tile_has_fragments(uvec2 tile) {
    uvec2 first = max(uint(TILE) * tile, FIRST), end = min(uint(TILE) * (tile + 1u), END);
    for (uint y = first.y; y < end.y; ++y)
        for (uint x = first.x; x < end.x; ++x)
            if (has_fragments(y * width + x)) return true;
    return false;
}

void list(uvec2 tile) {
    uint columns = (width + uint(TILE) - 1u) / uint(TILE);
    uint at = atomicAdd(tile_command[0], 1u);
    tile_list[at] = tile.y * columns + tile.x;
    atomicMax(tile_command[4], min(at + 1u, 65535u));  // every device can dispatch this many groups
}

void main() {
    uvec2 tiles = tiles_in_extent();
    uint number = gl_GlobalInvocationID.x;
    if (number == 0u) {
        tile_command[1] = 1u;
        tile_command[5] = 1u;
        tile_command[6] = 1u;
    }
    for (; number < tiles.x * tiles.y; number += gl_NumWorkGroups.x * uint(LISTERS)) {
        uvec2 tile = tile_in_extent(number);
        if (tile_has_fragments(tile)) list(tile);
    }
}

// Lists the square tiles in which a pixel has a fragment: an invocation per tile looks at its pixels until one has.
// It leaves the command that draws a strip of four corners for each, and the one that dispatches a group for each.
// Invariant: a tile is listed once where any of its pixels has a fragment, else never.
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

bool tile_has_fragments(uvec2 first) {
    uvec2 end = min(first + uint(TILE), uvec2(width, height));
    for (uint y = first.y; y < end.y; ++y)
        for (uint x = first.x; x < end.x; ++x)
            if (has_fragments(y * width + x)) return true;
    return false;
}

void main() {
    uint tile = gl_GlobalInvocationID.x;
    uvec2 tiles = (uvec2(width, height) + uint(TILE) - 1u) / uint(TILE);
    if (tile == 0u) {
        tile_command[0] = 4u;
        tile_command[5] = 1u;
        tile_command[6] = 1u;
    }
    if (tile >= tiles.x * tiles.y || !tile_has_fragments(uint(TILE) * uvec2(tile % tiles.x, tile / tiles.x))) return;
    uint at = atomicAdd(tile_command[1], 1u);
    tile_list[at] = tile;
    atomicMax(tile_command[4], min(at + 1u, 65535u));  // groups that every device dispatches
}

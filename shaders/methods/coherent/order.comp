// Orders each tile: of its pixels the one with the most fragments leads, and its slots are sorted by depth. Neighbours
// get nearly the same fragments in the same order of arrival, so that slot number r of this order is about the r-th
// nearest fragment of a neighbour, too. One invocation sorts one tile, so that no invocation waits for another.
// Invariant: for tile t of TILE_COUNT, tile_order[t] is the number of slots that are ordered, at most ORDERED, and
// tile_order[(r + 1) * TILE_COUNT + t] the r-th of them, nearest first.
// Source: a tile's order as the start of its pixels', Jakubowski 2024 (LucidRaster).
// Buffers: reads counter, nodes; writes tile_order.
#include "common/extent.glsl"
#include "common/local.glsl"
#include "common/sort.glsl"

layout(local_size_x = ORDERERS) in;

// Returns the pixel with the most fragments of the tile whose first pixel is `first`; `most` is their number.
uint leading_pixel(uvec2 first, out uint most) {
    uint leader = 0u;
    most = 0u;
    for (uint i = 0u; i < uint(TILE * TILE); ++i) {
        uvec2 xy = first + uvec2(i % uint(TILE), i / uint(TILE));
        if (!in_extent(xy)) continue;
        uint p = xy.y * width + xy.x, count = counter[p];
        if (count <= most) continue;
        most = count;
        leader = p;
    }
    return leader;
}

void order_tile(uvec2 tile) {
    uint t = tile.y * uint(TILE_COLUMNS) + tile.x, most, leader = leading_pixel(uint(TILE) * tile, most);
    uint ordered = min(most, uint(ORDERED));
    for (uint slot = 0u; slot < ordered; ++slot) {
        fragments[slot] = nodes_at(slot * pixels + leader);
        fragments[slot].y = slot;
    }
    sort_fragments(ordered);
    tile_order[t] = ordered;
    for (uint r = 0u; r < ordered; ++r) tile_order[(r + 1u) * uint(TILE_COUNT) + t] = fragments[r].y;
}

void main() {
    uvec2 tiles = tiles_in_extent();
    for (uint number = gl_GlobalInvocationID.x; number < tiles.x * tiles.y;
         number += gl_NumWorkGroups.x * uint(ORDERERS)) order_tile(tile_in_extent(number));
}

// Orders a tile in shared memory, as methods/coherent/order.comp does it for the whole screen. The pixel with the most
// fragments leads, and each invocation of the work group finds the rank of some of its slots by counting what lies
// before them.
// Invariant: ordered_slot(0) … ordered_slot(ordered - 1) are the slots 0 … ordered - 1 of the leading pixel, nearest
// first; fragments of equal depth keep the order of their slots.
// Source: a tile's order as the start of its pixels', Jakubowski 2024 (LucidRaster).
// Buffers: reads nodes.
#define LANES (TILE * TILE)
#define DEPTHS uint(LANES)
#define RANKED uint(LANES + ORDERED)

// The number of fragments of each pixel of the tile, then the depths of the leading pixel's fragments, then the order.
shared uint tile_words[LANES + 2 * ORDERED];

uint ordered_slot(uint rank) {
    return tile_words[RANKED + rank];
}

// Returns the pixel with the most fragments of the tile whose first pixel is `first`; `most` is their number.
uint leading_pixel(uvec2 first, out uint most) {
    uint leader = 0u;
    most = 0u;
    for (uint i = 0u; i < uint(LANES); ++i) {
        uint count = tile_words[i];
        if (count <= most) continue;
        most = count;
        leader = i;
    }
    return (first.y + leader / uint(TILE)) * width + first.x + leader % uint(TILE);
}

uint rank_of(uint slot, uint ordered) {
    uint depth = tile_words[DEPTHS + slot], rank = 0u;
    for (uint i = 0u; i < ordered; ++i) {
        uint other = tile_words[DEPTHS + i];
        if (other < depth || (other == depth && i < slot)) ++rank;
    }
    return rank;
}

// Returns the number of slots that are ordered. `count` is the number of fragments of this invocation's pixel.
uint share_order(uint count, uvec2 first) {
    uint lane = gl_LocalInvocationIndex, most;
    tile_words[lane] = count;
    barrier();
    uint leader = leading_pixel(first, most), ordered = min(most, uint(ORDERED));
    for (uint slot = lane; slot < ordered; slot += uint(LANES))
        tile_words[DEPTHS + slot] = nodes_at(slot * pixels + leader).x;
    barrier();
    for (uint slot = lane; slot < ordered; slot += uint(LANES)) tile_words[RANKED + rank_of(slot, ordered)] = slot;
    barrier();
    return ordered;
}

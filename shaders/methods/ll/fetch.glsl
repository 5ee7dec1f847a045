// Reads the first K fragments of a pixel's list, which is sorted by depth.
// Buffers: reads next, cells.
#include "common/helper.glsl"

uint fetch_node, fetch_left;

void fetch_begin(uint p) {
    fetch_node = IS_HELPER ? pixels + p : next_at(p);
    fetch_left = BOUND;
}

bool fetch_next(out uvec2 fragment) {
    fragment = cells_at(fetch_node);
    if (fetch_left == 0u || fragment.x == EMPTY) return false;
    --fetch_left;
    fetch_node = next_at(fetch_node);
    return true;
}

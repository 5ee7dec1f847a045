// Reads the fragments of a list in the order of its links.
// Buffers: reads next, cells.
#include "common/helper.glsl"

uint fetch_at;

void fetch_begin(uint list) {
    fetch_at = IS_HELPER ? EMPTY : next_at(list);
}

bool fetch_next(out FRAGMENT fragment) {
    if (fetch_at >= capacity) return false;
    fragment = cells_at(fetch_at);
    fetch_at = next_at(uint(BUCKETS) * pixels + fetch_at);
    return true;
}

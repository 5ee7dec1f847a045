// Reads the fragments of a pixel's list, in the order of its links.
#include "common/helper.glsl"

uint fetch_at;

void fetch_begin(uint p) {
    fetch_at = IS_HELPER ? EMPTY : next[p];
}

bool fetch_next(out uvec2 fragment) {
    if (fetch_at >= capacity) return false;
    fragment = cells[fetch_at];
    fetch_at = next[pixels + fetch_at];
    return true;
}

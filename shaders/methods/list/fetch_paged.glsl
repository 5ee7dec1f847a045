// Reads a pixel's pages, the last taken first, each from its last cell to its first.
#include "common/helper.glsl"

uint fetch_at;  // one past the next cell; 0 ends the list

void fetch_begin(uint p) {
    fetch_at = IS_HELPER ? 0u : place[p];
}

bool fetch_next(out FRAGMENT fragment) {
    if (fetch_at == 0u || fetch_at > capacity) return false;
    fragment = cells[--fetch_at];
    if (fetch_at % uint(PAGE) == 0u) fetch_at = page_link[fetch_at / uint(PAGE)];
    return true;
}

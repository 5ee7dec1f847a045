// Reads the fragments of a pixel's pages, from the page that was taken last to the first, and in each page from the
// last cell to the first.
// Buffers: reads place, cells, page_link.
#include "common/helper.glsl"

uint fetch_at;  // index of the next cell plus 1; 0 ends the list

void fetch_begin(uint p) {
    fetch_at = IS_HELPER ? 0u : place[p];
}

bool fetch_next(out FRAGMENT fragment) {
    if (fetch_at == 0u || fetch_at > capacity) return false;
    fragment = cells_at(--fetch_at);
    if (fetch_at % uint(PAGE) == 0u) fetch_at = page_link_at(fetch_at / uint(PAGE));
    return true;
}

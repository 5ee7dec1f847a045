// Linked lists of pages, store: each fragment takes the next cell of its pixel's page, the first links the page.
// Invariant: page_link[i] is place[p] from before page i was taken, so that the pages before it are read as full.
// Source: Crassin 2010.
#include "scene/fragment.glsl"
#include "methods/list/alloc.glsl"

void main() {
    if (rejected()) discard;
    uint cell;
    if (!allocate(pixel_index(), cell)) return;
    cells[cell] = incoming();
    if (cell % uint(PAGE) == 0u) page_link[cell / uint(PAGE)] = page_before;
}

// Store of linked lists of pages: each fragment takes the next cell of its pixel's page; the fragment that takes the
// first cell links the page to the previous one.
// Invariant: page_link[i] is the value of place[p] before page i was taken, so that earlier pages are read as full.
// Source: Crassin 2010.
// Buffers: writes cells, page_link.
#include "scene/fragment.glsl"
#include "methods/list/alloc.glsl"

void main() {
    if (rejected()) discard;
    uint cell;
    if (!allocate(pixel_index(), cell)) return;
    cells[cell] = incoming();
    if (cell % uint(PAGE) == 0u) page_link[cell / uint(PAGE)] = page_before;
}

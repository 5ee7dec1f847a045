// Linked lists, store: the new cell becomes the head of the pixel's list, unsorted.
// Invariant: following `next` from the head visits every fragment of the pixel once.
// Source: Yang et al. 2010; gpupro5_ch1 §1.2.1, Listing 1.1.
#include "scene/fragment.glsl"
#include "methods/list/alloc.glsl"

void main() {
    if (rejected()) discard;
    uint cell;
    if (!allocate(cell)) return;
    cells[cell] = incoming();
    next[pixels + cell] = atomicExchange(next[pixel_index()], cell);
}

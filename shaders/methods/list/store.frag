// Linked lists, store: the new cell becomes the head of the pixel's list, unsorted.
// Invariant: following `next` from the head visits every fragment of the list once.
// Source: Yang et al. 2010; gpupro5_ch1 §1.2.1, Listing 1.1.
#include "scene/fragment.glsl"
#include "methods/list/alloc.glsl"
#include "methods/list/choose.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index(), cell;
    if (!allocate(p, cell)) return;
    FRAGMENT fragment = incoming();
    cells[cell] = fragment;
    next[uint(BUCKETS) * pixels + cell] = atomicExchange(next[chosen_list(p, fragment.x)], cell);
}

// Store of linked lists: the cell of the fragment becomes the head of its list; the list is unsorted.
// Invariant: following `next` from the head visits every fragment of the list once.
// Source: Yang et al. 2010; gpupro5_ch1 §1.2.1, Listing 1.1.
// Buffers: updates next; writes cells.
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

// Cells of linked lists; none is ever given back. They come from one shared counter, or from pages.
// next[l] for l < BUCKETS * pixels is the head of list l; cell c has its link at next[BUCKETS * pixels + c].
// Invariant: cells allocated past the capacity are counted but not used; the frame is then redone.
// Source: gpupro5_ch1 §1.2.
#if ALLOCATION_PAGED
#include "methods/list/pages.glsl"
#else

bool allocate(uint p, out uint cell) {
    cell = atomicAdd(cell_counter[0], 1u);
    return cell < capacity;
}

#endif

// Allocates cells of linked lists, from one shared counter or in pages; cells are never freed. For l < BUCKETS *
// pixels, next[l] is the head of list l; the link of cell c is next[BUCKETS * pixels + c].
// Invariant: cells beyond the capacity are counted but not used; the frame is then drawn again with a larger capacity.
// Source: gpupro5_ch1 §1.2.
// Buffers: updates cell_counter.
#if ALLOCATION_PAGED
#include "methods/list/pages.glsl"
#else

bool allocate(uint p, out uint cell) {
#if ALLOCATION_DEDICATED
    cell = atomicCounterIncrement(cell_counter);
#else
    cell = atomicAdd(cell_counter[0], 1u);
#endif
    return cell < capacity;
}

#endif

// Locates the cells of a pixel: the first is at `first_cell`, that of another slot at `cell_of(slot)`, and all before
// `end_cell`. STEP(i) leads from the cell of slot i to the next. With PLANES every pixel of the region uses all of its
// cells. With DENSE and CHUNK above 1, that many cells of a pixel are adjacent, and then those of the next pixel.
// Invariant: addresses grow with the slot, so that a cell before `end_cell` is in use.
// Buffers: reads counter.
#include "methods/adaptive/region.glsl"
#if !DENSE
#include "methods/adaptive/fragment_count.glsl"
#endif

uint first_cell, end_cell, cell_step;

#if CHUNK > 1
#define STEP(i) (((i) & CHUNK - 1) == CHUNK - 1 ? (PLACES - 1u) * uint(CHUNK) + 1u : 1u)
#else
#define STEP(i) cell_step
#endif

uint cell_of(uint slot) {
#if CHUNK > 1
    return first_cell + slot / uint(CHUNK) * PLACES * uint(CHUNK) + slot % uint(CHUNK);
#else
    return first_cell + slot * cell_step;
#endif
}

void find_cells(uint p) {
#if DENSE
    first_cell = p * uint(CHUNK);
    cell_step = PLACES;
#if PLANES
    end_cell = p + capacity;
#else
    end_cell = min(cell_of(counter[p]), first_cell + capacity);
#endif
#else
    cell_step = 1u;
    end_cell = counter[p];
    first_cell = end_cell - fragment_count();
#endif
}

// Returns the number of fragments of pixel p, whose cells have been found.
uint cells_in_use(uint p) {
#if PLANES
    return capacity / PLACES;
#elif DENSE
    return min(counter[p], capacity / PLACES);
#else
    return end_cell - first_cell;
#endif
}

// Locates the cells of a pixel: they start at `first_cell`, are `cell_step` apart, and end before `end_cell`. With
// PLANES every pixel of the region uses all of its cells.
// Buffers: reads counter.
#include "methods/adaptive/region.glsl"
#if !DENSE
#include "methods/adaptive/fragment_count.glsl"
#endif

uint first_cell, end_cell, cell_step;

void find_cells(uint p) {
#if DENSE
    cell_step = PLACES;
    first_cell = p;
#if PLANES
    end_cell = p + capacity;
#else
    end_cell = p + counter[p] * cell_step;
#endif
#else
    cell_step = 1u;
    end_cell = counter[p];
    first_cell = end_cell - fragment_count();
#endif
}

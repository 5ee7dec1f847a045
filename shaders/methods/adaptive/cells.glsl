// The cells of a pixel: `cell_count` of them, from `first_cell` on, `cell_step` apart.
#include "methods/adaptive/region.glsl"
#if !DENSE
#include "methods/adaptive/tally.glsl"
#endif

uint first_cell, cell_step, cell_count;

void find_cells(uint p) {
#if DENSE
    cell_count = counter[p];
    first_cell = p;
    cell_step = PLACES;
#else
    cell_count = tallied();
    first_cell = counter[p] - cell_count;
    cell_step = 1u;
#endif
}

FRAGMENT cell(uint i) {
    return nodes[first_cell + i * cell_step];
}

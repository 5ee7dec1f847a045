// Counts the fragments that a pixel holds. Runs outside timed frames.
#include "methods/adaptive/cells.glsl"

void main() {
    find_cells(place());
    if (cell_count > 0u) atomicAdd(held_fragments, cell_count);
}

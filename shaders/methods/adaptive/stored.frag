// Counts the fragments that each pixel stores. This pass runs outside timed frames.
#include "methods/adaptive/cells.glsl"

void main() {
    find_cells(place());
    uint count = cells_in_use(place());
    if (count > 0u) atomicAdd(stored_fragments, count);
}

// Counts the generated fragments that the storage of their pixel contains. A k-buffer with hazards may lose, duplicate
// or tear fragments, so that the number of occupied slots would not tell. Fragments equal in depth and colour cannot be
// distinguished: one that is stored counts for all. This pass runs outside timed frames.
#include "scene/fragment.glsl"
#include <fetch>

void main() {
    if (rejected()) discard;
    FRAGMENT fragment = incoming(), held;
    bool found = false;
    for (fetch_begin(pixel_index()); !found && fetch_next(held);) found = held == fragment;
    if (found) atomicAdd(stored_fragments, 1u);
}

// Counts the generated fragments that their pixel really holds, where hazards may lose, double or tear them.
// Fragments equal in depth and colour cannot be told apart: one that is held counts for all. Runs outside timed frames.
#include "scene/fragment.glsl"
#include <fetch>

void main() {
    if (rejected()) discard;
    FRAGMENT fragment = incoming(), held;
    bool found = false;
    for (fetch_begin(pixel_index()); !found && fetch_next(held);) found = held == fragment;
    if (found) atomicAdd(stored_fragments, 1u);
}

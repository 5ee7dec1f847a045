// Counts the fragments that a pixel holds for its resolve: of each list no more than HOLDS, the room of the local
// array. Runs outside timed frames.
#include "common/pixel.glsl"
#include <fetch>

void main() {
    uint p = pixel_index(), held = 0u;
    for (uint list = 0u; list < uint(LISTS); ++list) {
        uint count = 0u;
        FRAGMENT fragment;
        for (fetch_begin(list * pixels + p); fetch_next(fragment);) ++count;
        held += min(count, uint(HOLDS));
    }
    if (held > 0u) atomicAdd(stored_fragments, held);
}

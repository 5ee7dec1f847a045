// Counts the fragments that each pixel stores for its resolve, at most HOLDS of each list: the resolve's local array
// has no room for more. This pass runs outside timed frames.
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

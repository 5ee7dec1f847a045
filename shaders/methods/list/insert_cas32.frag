// Sorted linked lists, store: walks to the place of the fragment and links it in by compare-and-swap.
// Invariant: each list is sorted by depth at any time; nothing is removed, so a failed swap retries from
// where it stands. Equal depths stay in order of arrival.
// Source: gpupro5_ch1 §1.2.3, after Harris 2001.
#include "scene/fragment.glsl"
#include "common/helper.glsl"
#include "methods/list/alloc.glsl"

void main() {
    if (rejected()) discard;
    uint cell;
    if (!allocate(cell)) return;
    uvec2 fragment = incoming();
    cells[cell] = fragment;
    uint at = pixel_index();
    bool linked = IS_HELPER;
    for (uint tries = 0u; !linked && tries < uint(LOCK_TRIES); ++tries) {
        uint following = next[at];
        if (following != EMPTY && cells[following].x <= fragment.x) {
            at = pixels + following;
        } else {
            next[pixels + cell] = following;
            memoryBarrierBuffer();
            linked = atomicCompSwap(next[at], following, cell) == following;
        }
    }
    if (!linked) atomicAdd(lost_fragments, 1u);
}

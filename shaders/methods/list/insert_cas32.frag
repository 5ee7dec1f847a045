// Store of sorted linked lists: fills a cell, walks to the place of the fragment and links the cell in by
// compare-and-swap. With early culling the cell is filled at the end of the walk, because a hidden fragment takes none.
// Invariant: each list is sorted by depth at all times. Nothing is removed, so a failed swap retries from the same
// place. Fragments of equal depth stay in order of arrival.
// Memory: a cell is read through a link that was loaded without a barrier behind it. OpenGL's coherent loads give what
// was published before the link was; Vulkan's model calls it a data race.
// Source: gpupro5_ch1 §1.2.3, after Harris 2001.
// Buffers: updates next, cells.
#include "scene/fragment.glsl"
#include "common/helper.glsl"
#include "common/early_culling.glsl"
#include "methods/list/alloc.glsl"

// Takes a cell and writes the fragment into it, unless the fragment has one; returns false if there is none left.
bool filled(uint p, FRAGMENT fragment, inout uint cell) {
    if (cell != EMPTY) return true;
    if (!allocate(p, cell)) return false;
    cells[cell] = fragment;
    return true;
}

void main() {
    if (rejected()) discard;
    FRAGMENT fragment = incoming();
    uint p = pixel_index(), at = p, cell = EMPTY;
#if !EARLY_CULLING_ON
    if (!filled(p, fragment, cell)) return;
#endif
    float opacity = 0.0;
    bool linked = false, going = !IS_HELPER;
    for (uint tries = 0u; going && tries < uint(LOCK_TRIES); ++tries) {
        uint following = next[at];
        if (following != EMPTY && cells[following].x <= fragment.x) {
            at = pixels + following;
#if EARLY_CULLING_ON
            opacity = covered(opacity, payload_of(cells[following]));
            COUNT(hidden, opacity >= CULLING_OPACITY)
            if (opacity >= CULLING_OPACITY) return;
#endif
        } else {
#if EARLY_CULLING_ON
            if (!filled(p, fragment, cell)) return;
#endif
            next[pixels + cell] = following;
            memoryBarrierBuffer();
            linked = atomicCompSwap(next[at], following, cell) == following;
            going = !linked;
        }
    }
    if (!linked) atomicAdd(lost_fragments, 1u);
}

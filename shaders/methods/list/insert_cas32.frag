// Store of sorted linked lists: walks to the place of the fragment and links its cell in by compare-and-swap. The cell
// is allocated at the end of the walk, not before it.
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

void main() {
    if (rejected()) discard;
    FRAGMENT fragment = incoming();
    uint p = pixel_index(), at = p, cell = EMPTY;
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
            if (cell == EMPTY) {
                if (!allocate(p, cell)) return;
                cells[cell] = fragment;
            }
            next[pixels + cell] = following;
            memoryBarrierBuffer();
            linked = atomicCompSwap(next[at], following, cell) == following;
            going = !linked;
        }
    }
    if (!linked) atomicAdd(lost_fragments, 1u);
}

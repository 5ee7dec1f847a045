// Allocates cells in pages of PAGE cells that belong to one pixel. place[p] is the next cell of pixel p. If it is a
// multiple of PAGE the page is full, or with 0 the pixel has no page yet. The bit TAKING is set while an invocation
// takes the next page.
// Invariant: all pages of a pixel but the last are full; a cell is given out once; the lock is held only to take a
// page.
// Source: Crassin 2010, as in gpupro5_ch1 §1.2, where every cell is taken under the lock.
// Buffers: updates place, cell_counter.
#include "common/helper.glsl"

const uint TAKING = 0x80000000u;
uint page_before;  // place[p] before `allocate` took a new page, of which it returned the first cell

bool allocate(uint p, out uint cell) {
    bool waiting = !IS_HELPER;
    uint seen = place[p];
    cell = EMPTY;
    for (uint tries = 0u; waiting && tries < uint(LOCK_TRIES); ++tries) {
        uint at = seen & ~TAKING;
        bool full = at % uint(PAGE) == 0u;
        seen = atomicCompSwap(place[p], at, full ? at | TAKING : at + 1u);
        if (seen == at) {
            waiting = false;
            cell = at;
            if (full) {
                page_before = at;
                uint page = atomicAdd(cell_counter[0], uint(PAGE));
                bool fits = page + uint(PAGE) <= capacity;
                atomicExchange(place[p], fits ? page + 1u : at);
                cell = fits ? page : EMPTY;
            }
        }
    }
    if (waiting) atomicAdd(lost_fragments, 1u);
    return cell != EMPTY;
}

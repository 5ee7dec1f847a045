// Build of open addressing: the fragment takes the first cell of its pixel's probe sequence that is empty or contains a
// younger fragment; the displaced fragment moves on along its own sequence (Robin Hood hashing). With ORDER_SORTED the
// search starts at the first probe, and of two fragments with equal age, which belong to one pixel, the nearer stays,
// so that the cells of a pixel are sorted. Otherwise the search starts behind the oldest fragment of the pixel.
// Invariant: ages[p] is at least the age of every fragment of pixel p. A cell only increases, so each step is one
// atomic maximum. Early culling counts only what is further than all that it has counted: a fragment that is displaced
// while others walk past it meets them again at its next age.
// Source: gpupro5_ch1 §1.3.2-1.3.3, Listings 1.4 and 1.5; interruption §1.5.2.
// Buffers: updates cell_counter, ages.
#include "scene/fragment.glsl"
#include "common/early_culling.glsl"
#include "methods/open/cell.glsl"
#include "methods/open/table.glsl"
#include "methods/open/probe.glsl"

// Requests a larger table; the frame will be drawn again.
void interrupt() {
    if (cell_counter[0] <= capacity) atomicMax(cell_counter[0], capacity + 1u);
}

// Tells whether more than LOAD_LIMIT / 65536 of the table is occupied.
bool crowded() {
    return cell_counter[0] > (capacity >> 16) * uint(LOAD_LIMIT) + ((capacity & 0xFFFFu) * uint(LOAD_LIMIT) >> 16);
}

uint age_before_first(uint p) {
#if ORDER_SORTED
    return 0u;
#else
    return ages[p];
#endif
}

void main() {
    if (rejected()) discard;
    if (crowded() || !table_begin()) {
        interrupt();
        return;
    }
    uint p = pixel_index(), age = age_before_first(p);
    uvec2 cell = cell_of(incoming()), met;
    bool placed = false, hidden = false, blocked = IS_HELPER;
#if EARLY_CULLING_ON
    float opacity = 0.0;
    uvec2 counted = uvec2(EMPTY);  // the furthest fragment that contributes to opacity
#endif
    for (uint tries = 0u; !(placed || hidden || blocked) && age < OLDEST && tries < uint(LOCK_TRIES); ++tries) {
        ++age;
        uint at = probe(p, age);
        cell = aged(cell, age);
        blocked = !table_max(at, cell, met);
        if (!blocked && less64(met, cell)) {
            atomicMax(ages[p], age);
            placed = met == uvec2(0u);
            age = age_of(met);
            p = prober(at, age);
            cell = met;
#if !ORDER_SORTED
            age = placed ? age : ages[p];
#endif
#if EARLY_CULLING_ON
            opacity = 0.0;
            counted = uvec2(EMPTY);
        } else if (!blocked && age_of(met) == age && less64(aged(met, 0u), counted)) {
            counted = aged(met, 0u);
            opacity = covered(opacity, met.x);
            hidden = opacity >= CULLING_OPACITY;
#endif
        }
    }
    COUNT(hidden, hidden)
    if (placed) atomicAdd(cell_counter[0], 1u);
    else if (blocked) atomicAdd(lost_fragments, 1u);
    else if (!hidden) interrupt();
}

// A cell of the hash table as (low word, high word): the low word is the RGBA8 colour, the high word an 8-bit age above
// a 24-bit inverted depth. 0 is an empty cell.
// Invariant: of two cells the older is the larger, and of cells with equal age the nearer, so the cells of a pixel are
// ordered.
// Source: gpupro5_ch1 §1.1.1, §1.3.2-1.3.3.
#include "common/payload.glsl"

const uint OLDEST = 255u;
const uint FURTHEST = 0xFFFFFFu;
const float DEPTH_STEPS = 16777216.0;

uint age_of(uvec2 cell) {
    return cell.y >> 24;
}

uvec2 aged(uvec2 cell, uint age) {
    return uvec2(cell.x, (cell.y & FURTHEST) | age << 24);
}

// The last step represents depth 1, the depth of distant geometry, instead of the depth just below it.
float depth_at(uint depth_step) {
    return depth_step == FURTHEST ? 1.0 : float(depth_step) / DEPTH_STEPS;
}

// Exact for depths on a 2^-24 grid other than 1 - 2^-24. Any other depth is rounded, which may change the order of the
// fragment, and is counted as a lost fragment.
uvec2 cell_of(FRAGMENT fragment) {
    float depth = uintBitsToFloat(fragment.x);
    uint depth_step = min(uint(depth * DEPTH_STEPS), FURTHEST);
    if (depth_at(depth_step) != depth) atomicAdd(lost_fragments, 1u);
    return uvec2(payload_of(fragment), FURTHEST - depth_step);
}

FRAGMENT fragment_in(uvec2 cell) {
    return fragment_of(floatBitsToUint(depth_at(FURTHEST - (cell.y & FURTHEST))), cell.x);
}

// A cell of the table as (low word, high word): RGBA8; age in 8 bits above inverted depth in 24. 0 is an empty cell.
// Invariant: of two cells the older is the larger, of equal age the nearer; so a pixel's cells keep their order.
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

// The last step stands for depth 1, where things far away are, and not for the one below it.
float depth_at(uint depth_step) {
    return depth_step == FURTHEST ? 1.0 : float(depth_step) / DEPTH_STEPS;
}

// Without loss for depths on a grid of 2^-24 but 1 - 2^-24. Any other may lose its place, which counts as a loss.
uvec2 cell_of(FRAGMENT fragment) {
    float depth = uintBitsToFloat(fragment.x);
    uint depth_step = min(uint(depth * DEPTH_STEPS), FURTHEST);
    if (depth_at(depth_step) != depth) atomicAdd(lost_fragments, 1u);
    return uvec2(payload_of(fragment), FURTHEST - depth_step);
}

FRAGMENT fragment_in(uvec2 cell) {
    return fragment_of(floatBitsToUint(depth_at(FURTHEST - (cell.y & FURTHEST))), cell.x);
}

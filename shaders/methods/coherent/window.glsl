// Composites the fragments of a pixel in the order of its tile, mended in a window of WINDOW fragments that stay in
// registers: each further fragment is inserted, and the nearest of all leaves. A pixel whose order the window cannot
// mend is resolved by itself. The including file defines ordered_slot(rank).
// Invariant: window[0 .. WINDOW) is sorted; as long as fewer than WINDOW fragments have come, its front is filled up
// with fragments that precede every other and are not composited. A fragment that comes after one behind it has left
// ends the walk.
// Source: Jakubowski 2024 (LucidRaster).
// Buffers: reads nodes.
#include "common/accumulate.glsl"
#include "common/enough.glsl"

FRAGMENT window[WINDOW];

// Inserts a fragment into the window; returns the nearest of both.
FRAGMENT exchange(FRAGMENT carried) {
    FRAGMENT held = window[0];
    bool first = held.x <= carried.x;
    FRAGMENT nearest = first ? held : carried;
    carried = first ? carried : held;
    for (int i = 1; i < WINDOW; ++i) {
        held = window[i];
        first = held.x <= carried.x;
        window[i - 1] = first ? held : carried;
        carried = first ? carried : held;
    }
    window[WINDOW - 1] = carried;
    return nearest;
}

// Returns the accumulated colour; `right` tells whether the window was wide enough to mend the order.
vec4 composite_in_order(uint p, uint count, uint ordered, out bool right) {
    uint met = 0u, depth = 0u;
    vec4 colour = nothing_yet();
    for (int i = 0; i < WINDOW; ++i) window[i] = FIRST_FRAGMENT;
    right = count <= ordered;
    for (uint rank = 0u; rank < ordered && right; ++rank) {
        uint slot = ordered_slot(rank);
        if (slot >= count) continue;
        FRAGMENT nearest = exchange(nodes_at(slot * pixels + p));
        right = nearest.x >= depth;
        depth = nearest.x;
        if (met++ >= uint(WINDOW)) colour = onto(colour, colour_of(nearest));
        if (enough(colour)) break;
    }
    for (int i = 0; i < WINDOW; ++i)
        if (uint(i) + met >= uint(WINDOW) && !enough(colour)) colour = onto(colour, colour_of(window[i]));
    return colour;
}

vec4 resolve_in_order(uint p, uint count, uint ordered) {
    bool right;
    vec4 colour = composite_in_order(p, count, ordered, right);
    return right ? composited(colour) : resolve_pixel(p);
}

// Selects the nearest fragments of a pixel into the local array. Once it is full, the furthest of it is looked for and
// put into element 0, where the next nearer fragment replaces it (max-array, kplus_2015 §3.2): not before, and not
// behind the last.
// Invariant: the first call for a pixel selects MOST_CHOSEN fragments. Elements behind those that a later one selects
// are of earlier calls, no further than its `from`, so that none is the furthest, and a loop of constant length over
// all of them, which is the faster, finds the same.
#include "common/local.glsl"

const uint MOST_CHOSEN = uint(min(LOCAL, KEEP));

void furthest_to_front() {
    FRAGMENT furthest = fragments[0];
    uint at = 0u;
    for (uint i = 1u; i < MOST_CHOSEN; ++i) {
        FRAGMENT fragment = fragments[i];
        if (fragment.x > furthest.x) {
            furthest = fragment;
            at = i;
        }
    }
    fragments[at] = fragments[0];
    fragments[0] = furthest;
}

// Selects the nearest `room` fragments at depth `from` or behind it. Returns how many there are in all; `left` is the
// nearest depth that is left out.
uint select_nearest(uint p, uint from, uint room, out uint left) {
    uint offered = 0u;
    left = EMPTY;
    FRAGMENT fragment;
    for (fetch_begin(p); offered < room && fetch_next(fragment);) {
        if (fragment.x < from) continue;
        fragments[offered] = fragment;
        ++offered;
    }
    bool changed = true;
    while (offered >= room) {
        if (changed) furthest_to_front();
        if (!fetch_next(fragment)) break;
        changed = false;
        if (fragment.x < from) continue;
        left = min(left, max(fragment.x, fragments[0].x));
        changed = fragment.x < fragments[0].x;
        if (changed) fragments[0] = fragment;
        ++offered;
    }
    return offered;
}

// Declares the local array of this invocation and selects the nearest fragments into it. While it is full, the furthest
// fragment is in element 0, where the next nearer fragment replaces it (max-array, kplus_2015 §3.2).
// Invariant: the elements behind those that are selected, up to MOST_CHOSEN, are FIRST_FRAGMENT, which is never the
// furthest: a loop of constant length over all of them is the faster.
FRAGMENT fragments[LOCAL];

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

// Offers a fragment to the selection of the nearest `room` fragments, after `offered` earlier ones. Returns the depth of
// the fragment that finds no place in it, or EMPTY.
uint offer(FRAGMENT fragment, uint offered, uint room) {
    bool full = offered >= room;
    uint furthest = full ? fragments[0].x : EMPTY;
    if (fragment.x >= furthest) return fragment.x;
    fragments[full ? 0u : offered] = fragment;
    if (offered + 1u >= room) furthest_to_front();
    return furthest;
}

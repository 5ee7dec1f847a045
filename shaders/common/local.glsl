// Declares the local array of this invocation and selects the nearest fragments into it. While it is full, the furthest
// fragment is in element 0, where the next nearer fragment replaces it (max-array, kplus_2015 §3.2).
FRAGMENT fragments[LOCAL];

// Tells whether `a` is replaced in favour of `b`. With BATCHES fragments of equal depth are ordered by their payload,
// so that each is on one side of a batch boundary; fragments with equal payload as well are interchangeable.
bool beyond(FRAGMENT a, FRAGMENT b) {
#if BATCHES
    return a.x > b.x || (a.x == b.x && payload_beyond(a, b));
#else
    return a.x > b.x;
#endif
}

void furthest_to_front(uint count) {
    FRAGMENT furthest = fragments[0];
    uint at = 0u;
    for (uint i = 1u; i < count; ++i) {
        FRAGMENT fragment = fragments[i];
        if (beyond(fragment, furthest)) {
            furthest = fragment;
            at = i;
        }
    }
    fragments[at] = fragments[0];
    fragments[0] = furthest;
}

// Offers a fragment to the selection of the nearest `room` fragments, after `offered` earlier ones.
void offer(FRAGMENT fragment, uint offered, uint room) {
    if (offered >= room && !beyond(fragments[0], fragment)) return;
    fragments[offered < room ? offered : 0u] = fragment;
    if (offered + 1u >= room) furthest_to_front(room);
}

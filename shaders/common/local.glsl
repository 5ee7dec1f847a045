// The invocation's local array, and the choice of the nearest fragments into it: the furthest of a full choice
// stands in slot 0, where it is the first to go (max-array, kplus_2015 §3.2).
FRAGMENT fragments[LOCAL];

// Whether `a` gives way to `b`. With batches fragments of equal depth need an order of their own, so that
// each is on one side of a boundary; equal ones are interchangeable.
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

// The fragment takes part in the choice of the nearest `room`; `offered` have done so before.
void offer(FRAGMENT fragment, uint offered, uint room) {
    if (offered >= room && !beyond(fragments[0], fragment)) return;
    fragments[offered < room ? offered : 0u] = fragment;
    if (offered + 1u >= room) furthest_to_front(room);
}

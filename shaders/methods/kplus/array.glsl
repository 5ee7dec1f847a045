// Max-array: slot 0 holds the furthest fragment, the others stand in any order (kplus_2015 §3.2).

// O(1): the new fragment takes the first empty slot, or slot 0 if it is the furthest.
void insert_empty(uint p, uint count, uvec2 fragment) {
    uvec2 furthest = NODE(p, 0u);
    bool beyond = count > 0u && fragment.x > furthest.x;
    NODE(p, count) = beyond ? furthest : fragment;
    if (beyond) NODE(p, 0u) = fragment;
}

// O(K): the new fragment replaces the furthest; the furthest of what is left moves to slot 0.
void insert_full(uint p, uvec2 fragment) {
    uvec2 furthest = fragment;
    uint at = 0u;
    for (uint slot = 1u; slot < uint(K); ++slot) {
        uvec2 node = NODE(p, slot);
        if (node.x > furthest.x) {
            furthest = node;
            at = slot;
        }
    }
    if (at > 0u) NODE(p, at) = fragment;
    NODE(p, 0u) = furthest;
}

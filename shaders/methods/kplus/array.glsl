// Max-array: slot 0 contains the worst fragment, and the other slots are in any order (kplus_2015 §3.2).
// Buffers: updates nodes.

// Writes the fragment into the free slot, in O(1).
void array_fill(uint p, uint slot, FRAGMENT fragment) {
    NODE(p, slot) = fragment;
}

// Replaces the fragment of slot 0, then moves the worst remaining fragment to slot 0, in O(room).
void array_replace(uint p, uint room, FRAGMENT fragment) {
    FRAGMENT worst = fragment;
    uint at = 0u;
    for (uint slot = 1u; slot < room; ++slot) {
        FRAGMENT node = NODE(p, slot);
        if (worse(node, worst)) {
            worst = node;
            at = slot;
        }
    }
    if (at > 0u) NODE(p, at) = fragment;
    NODE(p, 0u) = worst;
}

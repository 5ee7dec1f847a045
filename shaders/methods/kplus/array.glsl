// Max-array: slot 0 contains the worst fragment, and the other slots are in any order (kplus_2015 §3.2).
// Buffers: updates nodes.

// Writes the fragment into the free slot, in O(1).
void array_fill(uint p, uint slot, FRAGMENT fragment) {
    NODE(p, slot) = fragment;
}

// Replaces the fragment of slot 0, then moves the worst remaining fragment to slot 0, in O(room). The loop walks over
// places instead of slots, which saves a tenth of it on llvmpipe.
void array_replace(uint p, uint room, FRAGMENT fragment) {
    FRAGMENT worst = fragment;
    uint first = PLACE(p, 0u), found = first, end = PLACE(p, room);
    for (uint place = first + STRIDE; place < end; place += STRIDE) {
        FRAGMENT node = nodes[place];
        if (worse(node, worst)) {
            worst = node;
            found = place;
        }
    }
    if (found != first) nodes[found] = fragment;
    nodes[first] = worst;
}

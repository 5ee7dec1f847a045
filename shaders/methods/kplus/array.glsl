// Max-array: the slots behind slot 0 stand in any order (kplus_2015 §3.2).

// O(1): the fragment takes the slot.
void array_fill(uint p, uint slot, FRAGMENT fragment) {
    NODE(p, slot) = fragment;
}

// O(room): the fragment replaces what slot 0 holds; the worst of what is left moves there.
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

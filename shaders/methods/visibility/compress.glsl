// Reduces K + 1 nodes of a visibility function to K: removes one step by moving it to the node before it, namely the
// step whose move takes the least area from under the function.
// Invariant: nodes stay in order, and the transmittance behind the last of them does not change.
// Source: Salvi et al. 2011, §3.2.

// The last of the K + 1 nodes is `beyond`, which is not in a slot.
FRAGMENT node_at(uint p, uint slot, FRAGMENT beyond) {
    return slot < BOUND ? read_slot(p, slot) : beyond;
}

uint least_step(uint p, FRAGMENT beyond) {
    FRAGMENT before = read_slot(p, 0u);
    float through = node_factor(before), least = 2.0;
    uint chosen = 1u;
    for (uint slot = 1u; slot <= BOUND; ++slot) {
        FRAGMENT node = node_at(p, slot, beyond);
        float area = (node_depth(node) - node_depth(before)) * through * (1.0 - node_factor(node));
        if (area < least) {
            least = area;
            chosen = slot;
        }
        through *= node_factor(node);
        before = node;
    }
    return chosen;
}

void compress(uint p, FRAGMENT beyond) {
    uint gone = least_step(p, beyond);
    FRAGMENT kept = read_slot(p, gone - 1u);
    kept.y = floatBitsToUint(node_factor(kept) * node_factor(node_at(p, gone, beyond)));
    write_slot(p, gone - 1u, kept);
    for (uint slot = gone; slot < BOUND; ++slot) write_slot(p, slot, node_at(p, slot + 1u, beyond));
}

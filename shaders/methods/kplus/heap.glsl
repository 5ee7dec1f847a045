// Max-heap: no fragment is worse than its parent. The parent of slot i is slot i/2, and slot 0 is the parent of slot 1,
// so that the heap grows behind an empty slot 0 (kplus_2015 §3.2, with a root that has one child).
// Buffers: updates nodes.

// Inserts the fragment, in O(log room): the hole at the end rises until its parent is no better than the fragment.
void heap_fill(uint p, uint slot, FRAGMENT fragment) {
    uint hole = slot;
    while (hole > 1u) {
        FRAGMENT node = NODE(p, hole / 2u);
        if (!worse(fragment, node)) break;
        NODE(p, hole) = node;
        hole /= 2u;
    }
    NODE(p, hole) = fragment;
}

// Replaces the fragment of slot 0, in O(log room): the hole sinks until no child is worse than the fragment.
void heap_replace(uint p, uint room, FRAGMENT fragment) {
    uint hole = 0u;
    for (uint child = 1u; child < room; child = 2u * hole) {
        FRAGMENT node = NODE(p, child);
        if (child > 1u && child + 1u < room) {
            FRAGMENT right = NODE(p, child + 1u);
            if (worse(right, node)) {
                node = right;
                ++child;
            }
        }
        if (!worse(node, fragment)) break;
        NODE(p, hole) = node;
        hole = child;
    }
    NODE(p, hole) = fragment;
}

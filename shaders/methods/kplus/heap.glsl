// Max-heap: no fragment is nearer than its children at slots 2i+1 and 2i+2 (kplus_2015 §3.2).

// O(log K): the hole at the end rises until its parent is at least as far.
void insert_empty(uint p, uint count, uvec2 fragment) {
    uint hole = count;
    while (hole > 0u) {
        uint parent = (hole - 1u) / 2u;
        uvec2 node = NODE(p, parent);
        if (node.x >= fragment.x) break;
        NODE(p, hole) = node;
        hole = parent;
    }
    NODE(p, hole) = fragment;
}

// O(log K): the hole at the root sinks until both children are at most as far.
void insert_full(uint p, uvec2 fragment) {
    uint hole = 0u;
    for (uint child = 1u; child < uint(K); child = 2u * hole + 1u) {
        uvec2 node = NODE(p, child);
        if (child + 1u < uint(K)) {
            uvec2 right = NODE(p, child + 1u);
            if (right.x > node.x) {
                node = right;
                ++child;
            }
        }
        if (node.x <= fragment.x) break;
        NODE(p, hole) = node;
        hole = child;
    }
    NODE(p, hole) = fragment;
}

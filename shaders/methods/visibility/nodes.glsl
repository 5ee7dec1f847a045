// Nodes of a pixel's visibility function, stored in the slots of common/insert_sorted.glsl in order of depth, followed
// by empty slots. A node is (depth bits, bits of the factor by which the transmittance decreases at that depth).
// Buffers: reads nodes.

float node_depth(FRAGMENT node) {
    return uintBitsToFloat(node.x);
}

float node_factor(FRAGMENT node) {
    return uintBitsToFloat(node.y);
}

// The transmittance in front of `depth`; nodes at that depth do not contribute.
float visibility(uint p, uint depth) {
    float through = 1.0;
    for (uint slot = 0u; slot < BOUND; ++slot) {
        FRAGMENT node = nodes_at(slot * pixels + p);
        if (node.x >= depth) break;
        through *= node_factor(node);
    }
    return through;
}

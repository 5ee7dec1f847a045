// Nodes of a pixel's visibility function in the slots of common/insert_sorted.glsl: depth bits, and the bits of the
// factor by which the transmittance falls there. In order of depth, then empty slots.
#define NODE(p, slot) nodes[(slot) * pixels + (p)]

float node_depth(FRAGMENT node) {
    return uintBitsToFloat(node.x);
}

float node_factor(FRAGMENT node) {
    return uintBitsToFloat(node.y);
}

// The transmittance in front of `depth`: nodes at that depth do not count.
float visibility(uint p, uint depth) {
    float through = 1.0;
    for (uint slot = 0u; slot < uint(K); ++slot) {
        FRAGMENT node = NODE(p, slot);
        if (node.x >= depth) break;
        through *= node_factor(node);
    }
    return through;
}

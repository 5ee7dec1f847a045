// Layout of the K slots of a pixel in KB-PS and KB: the nearest fragments in order of depth, followed by empty slots.
// KB guarantees that order only if no hazard has occurred.
// Buffers: reads and writes nodes.
#define SLOT(p, slot) nodes[(slot) * pixels + (p)]

FRAGMENT read_slot(uint p, uint slot) {
    return SLOT(p, slot);
}

void write_slot(uint p, uint slot, FRAGMENT fragment) {
    SLOT(p, slot) = fragment;
}

// The K slots of a pixel in KB-PS and KB, where hazards spare them: its nearest fragments in order of depth, then empty
// slots.
#define SLOT(p, slot) nodes[(slot) * pixels + (p)]

FRAGMENT read_slot(uint p, uint slot) {
    return SLOT(p, slot);
}

void write_slot(uint p, uint slot, FRAGMENT fragment) {
    SLOT(p, slot) = fragment;
}

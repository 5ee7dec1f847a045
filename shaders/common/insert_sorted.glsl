// Inserts a fragment into the K sorted slots of a pixel, nearest first: it takes the place of the first fragment that
// is further away, which moves on to the next slot, and so on. Returns the fragment that falls out at the end, or EMPTY
// if there was room. With STORES_ALL every slot is written, whether its fragment moves or not. The including file
// defines read_slot and write_slot; an empty slot reads as EMPTY. Without mutual exclusion, concurrent fragments
// overwrite each other's moves (read-modify-write hazard).
FRAGMENT insert_sorted(uint p, FRAGMENT fragment) {
    for (uint slot = 0u; slot < BOUND && (STORES_ALL == 1 || fragment.x != EMPTY); ++slot) {
        FRAGMENT held = read_slot(p, slot);
        if (fragment.x < held.x) {
            write_slot(p, slot, fragment);
            fragment = held;
        }
#if STORES_ALL
        else write_slot(p, slot, held);
#endif
    }
    return fragment;
}

// Sorted insertion into K slots, nearest first: the fragment takes the place of the first that is further, which
// moves on in its stead. Returns the furthest of all, which falls out; EMPTY where there was room. The includer gives
// read_slot and write_slot; an empty slot reads as EMPTY. Without exclusion, fragments in flight overwrite each
// other's moves (read-modify-write hazard).
FRAGMENT insert_sorted(uint p, FRAGMENT fragment) {
    for (uint slot = 0u; slot < uint(K) && fragment.x != EMPTY; ++slot) {
        FRAGMENT held = read_slot(p, slot);
        if (fragment.x < held.x) {
            write_slot(p, slot, fragment);
            fragment = held;
        }
    }
    return fragment;
}

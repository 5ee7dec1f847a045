// Sorts fragments[0 .. count) of the local array by depth, nearest first. The hybrid sort uses insertion sort up to 16
// fragments and shell sort above; SORT_* select one of the two alone (kplus_2015 §3.3) or bubble sort (gpupro5_ch1
// §1.4.1).

void sort_by_gap(uint count, uint gap) {
    for (uint i = gap; i < count; ++i) {
        FRAGMENT moving = fragments[i];
        uint hole = i;
        for (; hole >= gap; hole -= gap) {
            FRAGMENT nearer = fragments[hole - gap];
            if (nearer.x <= moving.x) break;
            fragments[hole] = nearer;
        }
        fragments[hole] = moving;
    }
}

void insertion_sort(uint count) {
    sort_by_gap(count, 1u);
}

// The rounds of a shell sort before its last, which is an insertion sort. Gaps: Ciura 2001.
void sort_coarsely(uint count) {
    const uint GAPS[6] = uint[](301u, 132u, 57u, 23u, 10u, 4u);
    for (int i = 0; i < 6; ++i)
        if (GAPS[i] < uint(LOCAL) && GAPS[i] < count) sort_by_gap(count, GAPS[i]);
}

// Each round moves the furthest of the unsorted fragments to their end.
void bubble_sort(uint count) {
    for (uint end = count; end > 1u; --end) {
        FRAGMENT carried = fragments[0];
        for (uint i = 1u; i < end; ++i) {
            FRAGMENT met = fragments[i];
            bool further = met.x >= carried.x;
            fragments[i - 1u] = further ? carried : met;
            if (further) carried = met;
        }
        fragments[end - 1u] = carried;
    }
}

void sort_fragments(uint count) {
#if SORT_BUBBLE
    bubble_sort(count);
#else
#if SORT_SHELL
    sort_coarsely(count);
#elif !SORT_INSERTION
    if (LOCAL > 16 && count > 16u) sort_coarsely(count);
#endif
    insertion_sort(count);
#endif
}

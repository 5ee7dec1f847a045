// Sorts fragments[0 .. count) of the invocation's local array by depth, nearest first.
// Insertion sort up to 16 fragments, shell sort above, or either alone (kplus_2015 §3.3).
uvec2 fragments[LOCAL];  // depth bits, RGBA8

void sort_by_gap(uint count, uint gap) {
    for (uint i = gap; i < count; ++i) {
        uvec2 moving = fragments[i];
        uint hole = i;
        for (; hole >= gap; hole -= gap) {
            uvec2 nearer = fragments[hole - gap];
            if (nearer.x <= moving.x) break;
            fragments[hole] = nearer;
        }
        fragments[hole] = moving;
    }
}

void insertion_sort(uint count) {
    sort_by_gap(count, 1u);
}

// Gaps of Ciura 2001.
void shell_sort(uint count) {
    const uint GAPS[7] = uint[](301u, 132u, 57u, 23u, 10u, 4u, 1u);
    for (int i = 0; i < 7; ++i)
        if (GAPS[i] < count || GAPS[i] == 1u) sort_by_gap(count, GAPS[i]);
}

void sort_fragments(uint count) {
#if SORT_INSERTION
    insertion_sort(count);
#elif SORT_SHELL
    shell_sort(count);
#else
    if (count <= 16u) insertion_sort(count);
    else shell_sort(count);
#endif
}

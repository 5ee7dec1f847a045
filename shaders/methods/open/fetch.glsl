// Reads the fragments of a pixel from the hash table: walks its probe sequence and returns the cells whose age equals
// the number of the probe.
// Buffers: reads cells, ages, and records if 64-bit atomics are emulated.
#include "methods/open/cell.glsl"
#include "methods/open/probe.glsl"

uvec2 cell_at(uint at) {
#if ATOMIC64_NATIVE
    return cells_at(at);
#else
    uint record = cells_at(at);
    return record == 0u ? uvec2(0u) : records_at(record - 1u);
#endif
}

uint fetch_p, fetch_age, fetch_oldest;

void fetch_begin(uint p) {
    fetch_p = p;
    fetch_age = 0u;
    fetch_oldest = ages[p];
}

bool fetch_next(out FRAGMENT fragment) {
    while (fetch_age < fetch_oldest) {
        uvec2 cell = cell_at(probe(fetch_p, ++fetch_age));
        if (age_of(cell) == fetch_age) {
            fragment = fragment_in(cell);
            return true;
        }
    }
    return false;
}

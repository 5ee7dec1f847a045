// Adds a fragment to the hash table by an atomic maximum of cells; `met` receives the cell that was there before. With
// ATOMIC64_NATIVE cells have 64 bits and the device's own atomics are used. Otherwise a cell is 1 + the index of a
// record, and compare-and-swap installs the larger record or confirms the one that is there; when a fragment is
// displaced, its record moves along with it.
// Invariant: a record does not change while a cell refers to it; otherwise only the invocation that carries it uses it.
// A record never returns to a cell that it has left, so a compare-and-swap that finds the index finds the content that
// was read (no ABA).
// Memory: the record is read through an index that was loaded without a barrier behind it. OpenGL's coherent loads give
// what was published before the index was; Vulkan's model calls it a data race.
// Source: gpupro5_ch1 §1.3.2; §1.6 emulates atomicMax by a 64-bit compare-and-swap, which GLSL does not have here
// either.
// Buffers: updates cells; if 64-bit atomics are emulated, updates records, record_counter.
#include "common/helper.glsl"
#include "common/less64.glsl"

#if ATOMIC64_NATIVE

#define BUFFER64 cells
#include "common/atomic64.glsl"

bool table_begin() {
    return true;
}

bool table_max(uint at, uvec2 cell, out uvec2 met) {
    return atomic_max64(at, cell, met);
}

#else

uint carried;

bool table_begin() {
    carried = atomicAdd(record_counter[0], 1u);
    return carried < capacity;
}

bool table_max(uint at, uvec2 cell, out uvec2 met) {
    records[carried] = cell;
    memoryBarrierBuffer();
    uint named = cells[at], before = ~named;
    bool larger = false;
    for (uint tries = 0u; before != named && tries < uint(LOCK_TRIES); ++tries) {
        met = named == 0u ? uvec2(0u) : records[named - 1u];
        memoryBarrierBuffer();
        larger = less64(met, cell);
        before = named;
        named = atomicCompSwap(cells[at], before, larger ? carried + 1u : before);
    }
    if (larger && before == named) carried = named - 1u;
    return before == named;
}

#endif

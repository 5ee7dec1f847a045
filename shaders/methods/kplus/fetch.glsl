// Reads the fragments that the k+-buffer of a pixel has kept, in the order of its slots.
// Buffers: reads nodes.
#include "methods/kplus/slots.glsl"

#define FETCH_COUNT(p) taken(p)

uint fetch_pixel, fetch_slot, fetch_end;

void fetch_begin(uint p) {
    FIND_CELLS(p)
    uint count = FETCH_COUNT(p);
    fetch_pixel = p;
    fetch_slot = count < ROOM(p) ? 1u : 0u;
    fetch_end = fetch_slot + count;
}

bool fetch_next(out FRAGMENT fragment) {
    bool found = fetch_slot < fetch_end;
    if (found) fragment = nodes_at(PLACE(fetch_pixel, fetch_slot));
    ++fetch_slot;
    return found;
}

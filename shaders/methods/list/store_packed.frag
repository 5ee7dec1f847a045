// Linked lists with depth and link in one 64-bit record, store: one exchange links the new cell.
// Invariant: record[x] holds the depth and link of the fragment that follows x; 0 ends the list.
// Source: gpupro5_ch1 §1.2.2, Listing 1.2.
#include "scene/fragment.glsl"
#include "methods/list/alloc.glsl"

void main() {
    if (rejected()) discard;
    uint cell;
    if (!allocate(cell)) return;
    uvec2 fragment = incoming();
    payload[cell] = fragment.y;
    records[pixels + cell] = atomicExchange(records[pixel_index()], packUint2x32(uvec2(pixels + cell, ~fragment.x)));
}

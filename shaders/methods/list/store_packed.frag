// Store of linked lists with depth and link in one 64-bit record: one atomic exchange links the new cell.
// Invariant: records[x] is the link to, and the inverted depth of, the fragment that follows x; 0 ends the list.
// Source: gpupro5_ch1 §1.2.2, Listing 1.2.
// Buffers: updates records; writes payload.
#define BUFFER64 records
#include "scene/fragment.glsl"
#include "common/exchange64.glsl"
#include "methods/list/alloc.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index(), cell;
    if (!allocate(p, cell)) return;
    FRAGMENT fragment = incoming();
    uvec2 before;
    payload[cell] = payload_of(fragment);
    if (exchange64(p, uvec2(pixels + cell, ~fragment.x), before)) store64(pixels + cell, before);
    else atomicAdd(lost_fragments, 1u);
}

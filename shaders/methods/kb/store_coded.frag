// Store of the memory-hazard-aware k-buffer: inserts as the k-buffer does, into slots with a code that reveals when a
// hazard has torn them.
// Source: Zhang 2014, reconstructed from kplus_2015 §2 and Table 1.
// Buffers: reads and writes depths, colours.
#include "scene/fragment.glsl"
#include "methods/kb/coded.glsl"

FRAGMENT read_slot(uint p, uint slot) {
    uint at = slot * pixels + p;
    return decoded(depths[at], colours[at]);
}

void write_slot(uint p, uint slot, FRAGMENT fragment) {
    uint at = slot * pixels + p;
    depths[at] = coded(fragment.x, fragment.y);
    colours[at] = fragment.y;
}

#include "common/insert_sorted.glsl"

void main() {
    if (rejected()) discard;
    insert_sorted(pixel_index(), incoming());
}

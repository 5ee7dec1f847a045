// Tidy pass of the multi-pass k-buffer: adds the nearest missing fragment, sorts the slots, and removes duplicates.
// Invariant: afterwards depths strictly increase up to the first empty slot. Of fragments with equal depth the one that
// the depth test has kept stays.
#include "common/pixel.glsl"
#include "common/local.glsl"
#include "common/sort.glsl"
#include "methods/ps/slots.glsl"

const uint NO_DEPTH = 0x3F800000u;  // 1.0, the clear value of the layer's depth; its colour is cleared to 0

uint collect(uint p) {
    ivec2 xy = ivec2(gl_FragCoord.xy);
    fragments[0] = FRAGMENT(floatBitsToUint(texelFetch(layer_depth, xy, 0).x), texelFetch(layer, xy, 0).x);
    uint count = fragments[0] == FRAGMENT(NO_DEPTH, 0u) ? 0u : 1u;
    for (uint slot = 0u; slot < BOUND; ++slot) {
        FRAGMENT held = read_slot(p, slot);
        if (held.x != EMPTY) fragments[count++] = held;
    }
    return count;
}

void main() {
    uint p = pixel_index();
    uint count = collect(p), kept = 0u, last = EMPTY;
    sort_by_gap(count, 1u);  // insertion sort is stable
    for (uint i = 0u; i < count && kept < BOUND; ++i) {
        if (fragments[i].x != last) write_slot(p, kept++, fragments[i]);
        last = fragments[i].x;
    }
    for (; kept < BOUND; ++kept) write_slot(p, kept, FRAGMENT(EMPTY, 0u));
}

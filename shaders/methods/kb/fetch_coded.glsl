// Reads the slots of a pixel whose code is right, in any order.
// Buffers: reads depths, colours.
#include "methods/kb/coded.glsl"

uint fetch_pixel, fetch_slot;

void fetch_begin(uint p) {
    fetch_pixel = p;
    fetch_slot = 0u;
}

bool fetch_next(out FRAGMENT fragment) {
    for (; fetch_slot < BOUND; ++fetch_slot) {
        uint at = fetch_slot * pixels + fetch_pixel;
        fragment = decoded(depths_at(at), colours_at(at));
        if (fragment.x != EMPTY) {
            ++fetch_slot;
            return true;
        }
    }
    return false;
}

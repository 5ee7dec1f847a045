// Reads the slots of a pixel whose code is right, in any order.
#include "methods/kb/coded.glsl"

uint fetch_pixel, fetch_slot;

void fetch_begin(uint p) {
    fetch_pixel = p;
    fetch_slot = 0u;
}

bool fetch_next(out FRAGMENT fragment) {
    for (; fetch_slot < BOUND; ++fetch_slot) {
        fragment = read_slot(fetch_pixel, fetch_slot);
        if (fragment.x != EMPTY) {
            ++fetch_slot;
            return true;
        }
    }
    return false;
}

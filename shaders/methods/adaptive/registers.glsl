// What a pixel has, from the cell `at` on, into the registers of a network, and from there into the colour.
#include "common/network.glsl"

#define LOAD(i) \
    block[i] = NO_FRAGMENT; \
    if (at < end_cell) block[i] = nodes[at]; \
    at += cell_step;
#define COMPOSITE(i) colour = behind_of(colour, colour_of(block[i]));

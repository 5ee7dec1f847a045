// Defines how fragments move between the cells of a pixel, the registers of the sorting network, and the colour:
// LOAD(i) reads the cell `at` into register i, COMPOSITE(i) composites register i.
// Buffers: reads nodes.
#include "common/network.glsl"

#define LOAD(i) \
    block[i] = NO_FRAGMENT; \
    if (at < end_cell) block[i] = nodes_at(at); \
    at += STEP(i);
#define COMPOSITE(i) colour = behind_of(colour, colour_of(block[i]));

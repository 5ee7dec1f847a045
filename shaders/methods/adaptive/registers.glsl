// Defines how fragments move between the cells of a pixel, the registers of the sorting network, and the colour:
// LOAD(i) reads the cell `at` into register i, LOAD16(i) sixteen from there on, COMPOSITE(i) composites register i.
// PAIRS reads two cells at once, which are adjacent in chunks of eight, and in the place of those that are not in use
// the first two again: on llvmpipe a load that no branch guards costs less, and so does one from a known line.
// Buffers: reads nodes.
#include "common/network.glsl"

#if PAIRS
#define LOAD_PAIR(i, cell) { \
    bool in_use = cell < end_cell; \
    uvec4 pair = nodes_pair_at((in_use ? cell : first_cell) >> 1); \
    block[i] = in_use ? pair.xy : NO_FRAGMENT; \
    block[(i) + 1] = cell + 1u < end_cell ? pair.zw : NO_FRAGMENT; }
#define LOAD8(i) \
    LOAD_PAIR(i, at) LOAD_PAIR((i) + 2, (at + 2u)) LOAD_PAIR((i) + 4, (at + 4u)) LOAD_PAIR((i) + 6, (at + 6u)) \
    at += PLACES * uint(CHUNK);
#define LOAD16(i) LOAD8(i) LOAD8((i) + 8)
#else
#define LOAD(i) \
    block[i] = NO_FRAGMENT; \
    if (at < end_cell) block[i] = nodes_at(at); \
    at += STEP(i);
#define LOAD16(i) EACH16(LOAD, i)
#endif
#if NETWORK < 16
#define LOAD_BLOCK EACH(LOAD)
#elif NETWORK == 16
#define LOAD_BLOCK LOAD16(0)
#else
#define LOAD_BLOCK LOAD16(0) LOAD16(16)
#endif
#define COMPOSITE(i) colour = behind_of(colour, colour_of(block[i]));

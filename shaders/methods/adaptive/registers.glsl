// Defines how fragments move between the cells of a pixel, the registers of the sorting network, and the colour:
// LOAD(i) reads the cell `at` into register i, LOAD_BLOCK as many as a network sorts, LOAD_SECOND those of the second
// block, COMPOSITE(i) composites register i.
// PAIRS reads two cells at once, which are adjacent in chunks of eight, and in the place of those that are not in use
// the first two again: on llvmpipe a load that no branch guards costs less, and so does one from a known line.
// Buffers: reads nodes.
#include "common/network.glsl"

#if PAIRS
#define LOAD_PAIR(a, b, cell) { \
    bool in_use = cell < end_cell; \
    uvec4 pair = nodes_pair_at((in_use ? cell : first_cell) >> 1); \
    block##a = in_use ? pair.xy : NO_FRAGMENT; \
    block##b = cell + 1u < end_cell ? pair.zw : NO_FRAGMENT; }
#define LOAD8(a, b, c, d, e, f, g, h) \
    LOAD_PAIR(a, b, at) LOAD_PAIR(c, d, (at + 2u)) LOAD_PAIR(e, f, (at + 4u)) LOAD_PAIR(g, h, (at + 6u)) \
    at += PLACES * uint(CHUNK);
#define LOAD16 LOAD8(0, 1, 2, 3, 4, 5, 6, 7) LOAD8(8, 9, 10, 11, 12, 13, 14, 15)
#define LOAD32 LOAD16 LOAD8(16, 17, 18, 19, 20, 21, 22, 23) LOAD8(24, 25, 26, 27, 28, 29, 30, 31)
#define LOAD_SECOND \
    LOAD8(32, 33, 34, 35, 36, 37, 38, 39) LOAD8(40, 41, 42, 43, 44, 45, 46, 47) \
    LOAD8(48, 49, 50, 51, 52, 53, 54, 55) LOAD8(56, 57, 58, 59, 60, 61, 62, 63)
#else
#define LOAD(i) \
    block##i = NO_FRAGMENT; \
    if (at < end_cell) block##i = nodes_at(at); \
    at += STEP(i);
#define LOAD16 EACH16(LOAD)
#define LOAD32 EACH32(LOAD)
#define LOAD_SECOND NEXT32(LOAD)
#endif
#if NETWORK < 16
#define LOAD_BLOCK EACH(LOAD)
#elif NETWORK == 16
#define LOAD_BLOCK LOAD16
#else
#define LOAD_BLOCK LOAD32
#endif
#define COMPOSITE(i) colour = behind_of(colour, colour_of(block##i));

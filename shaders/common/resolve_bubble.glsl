// Bubble sort of at most 16 fragments in registers: resolve_register with another sort of its one block. Loops over a
// local array would be the same steps, but as many bounds as pixels keep a compiler from unrolling them, and the array
// in memory.
// Source: gpupro5_ch1 §1.4.1.
#include "common/network.glsl"

// ROUNDn moves the furthest of the first n fragments to their end.
#define ROUND2 COMPARE(0, 1)
#define ROUND3 ROUND2 COMPARE(1, 2)
#define ROUND4 ROUND3 COMPARE(2, 3)
#define ROUND5 ROUND4 COMPARE(3, 4)
#define ROUND6 ROUND5 COMPARE(4, 5)
#define ROUND7 ROUND6 COMPARE(5, 6)
#define ROUND8 ROUND7 COMPARE(6, 7)
#define ROUND9 ROUND8 COMPARE(7, 8)
#define ROUND10 ROUND9 COMPARE(8, 9)
#define ROUND11 ROUND10 COMPARE(9, 10)
#define ROUND12 ROUND11 COMPARE(10, 11)
#define ROUND13 ROUND12 COMPARE(11, 12)
#define ROUND14 ROUND13 COMPARE(12, 13)
#define ROUND15 ROUND14 COMPARE(13, 14)
#define ROUND16 ROUND15 COMPARE(14, 15)
#define BUBBLE8 ROUND8 ROUND7 ROUND6 ROUND5 ROUND4 ROUND3 ROUND2
#define BUBBLE16 ROUND16 ROUND15 ROUND14 ROUND13 ROUND12 ROUND11 ROUND10 ROUND9 BUBBLE8

#undef SORT_BLOCK
#if NETWORK == 8
#define SORT_BLOCK BUBBLE8
#else
#define SORT_BLOCK BUBBLE16
#endif

#include "common/resolve_register.glsl"

// Sorting network over registers: sorts block[0 .. NETWORK) by depth, nearest first, without loops and without variable
// indices, so that the compiler keeps the block in registers. NETWORK is a power of two up to 32, or 64 for two blocks.
// Source: odd-even merge sort and bitonic merge, Batcher 1968; use of registers, Knowles, Leach and Zambetta 2014
// (kplus_2015 [34]).
FRAGMENT block[NETWORK];

#define COMPARE(a, b) { \
    FRAGMENT low = block[a], high = block[b]; \
    bool swapped = high.x < low.x; \
    COUNT(moved, swapped ? 2u : 0u) \
    block[a] = swapped ? high : low; \
    block[b] = swapped ? low : high; }

// MERGEn(a, s) sorts the n fragments a, a + s, a + 2s, …, both halves of which are sorted already.
#define MERGE2(a, s) COMPARE(a, (a) + (s))
#define MERGE4(a, s) MERGE2(a, 2 * (s)) MERGE2((a) + (s), 2 * (s)) COMPARE((a) + (s), (a) + 2 * (s))
#define PAIRS2(a, s) COMPARE(a, (a) + (s)) COMPARE((a) + 2 * (s), (a) + 3 * (s))
#define PAIRS4(a, s) PAIRS2(a, s) PAIRS2((a) + 4 * (s), s)
#define PAIRS8(a, s) PAIRS4(a, s) PAIRS4((a) + 8 * (s), s)
#define MERGE8(a, s) MERGE4(a, 2 * (s)) MERGE4((a) + (s), 2 * (s)) \
    PAIRS2((a) + (s), s) COMPARE((a) + 5 * (s), (a) + 6 * (s))
#define MERGE16(a, s) MERGE8(a, 2 * (s)) MERGE8((a) + (s), 2 * (s)) \
    PAIRS4((a) + (s), s) PAIRS2((a) + 9 * (s), s) COMPARE((a) + 13 * (s), (a) + 14 * (s))
#define MERGE32(a) MERGE16(a, 2) MERGE16((a) + 1, 2) \
    PAIRS8((a) + 1, 1) PAIRS4((a) + 17, 1) PAIRS2((a) + 25, 1) COMPARE((a) + 29, (a) + 30)

#define SORT4(a) MERGE2(a, 1) MERGE2((a) + 2, 1) MERGE4(a, 1)
#define SORT8(a) SORT4(a) SORT4((a) + 4) MERGE8(a, 1)
#define SORT16(a) SORT8(a) SORT8((a) + 8) MERGE16(a, 1)
#define SORT32(a) SORT16(a) SORT16((a) + 16) MERGE32(a)

// CLEANn(a) sorts the n fragments from a on if they are a bitonic sequence: increasing then decreasing, or reversed.
#define APART4(a, s) COMPARE(a, (a) + (s)) COMPARE((a) + 1, (a) + 1 + (s)) \
    COMPARE((a) + 2, (a) + 2 + (s)) COMPARE((a) + 3, (a) + 3 + (s))
#define CLEAN4(a) COMPARE(a, (a) + 2) COMPARE((a) + 1, (a) + 3) COMPARE(a, (a) + 1) COMPARE((a) + 2, (a) + 3)
#define CLEAN8(a) APART4(a, 4) CLEAN4(a) CLEAN4((a) + 4)
#define CLEAN16(a) APART4(a, 8) APART4((a) + 4, 8) CLEAN8(a) CLEAN8((a) + 8)
#define CLEAN32(a) APART4(a, 16) APART4((a) + 4, 16) APART4((a) + 8, 16) APART4((a) + 12, 16) \
    CLEAN16(a) CLEAN16((a) + 16)

// EACH(DO) expands to DO(0) … DO(NETWORK - 1).
#define EACH4(DO, a) DO(a) DO((a) + 1) DO((a) + 2) DO((a) + 3)
#define EACH8(DO, a) EACH4(DO, a) EACH4(DO, (a) + 4)
#define EACH16(DO, a) EACH8(DO, a) EACH8(DO, (a) + 8)
#define EACH32(DO, a) EACH16(DO, a) EACH16(DO, (a) + 16)

#if NETWORK == 64
// Two blocks of 32: the including file sorts the parts that it needs.
#elif NETWORK == 2
#define EACH(DO) DO(0) DO(1)
#define SORT_BLOCK COMPARE(0, 1)
#elif NETWORK == 4
#define EACH(DO) EACH4(DO, 0)
#define SORT_BLOCK SORT4(0)
#elif NETWORK == 8
#define EACH(DO) EACH8(DO, 0)
#define SORT_BLOCK SORT8(0)
#elif NETWORK == 16
#define EACH(DO) EACH16(DO, 0)
#define SORT_BLOCK SORT16(0)
#else
#define EACH(DO) EACH32(DO, 0)
#define SORT_BLOCK SORT32(0)
#endif

// Sorting network over registers: SORT_BLOCK sorts the fragments block0, block1, … by depth, nearest first, without
// loops and without variable indices, so that the compiler keeps them in registers. There are NETWORK of them, a power
// of two up to 32, or 64 for two blocks. Each is a variable of its own, which macros name by its number: elements of an
// array take compilers twice as long.
// Source: odd-even merge sort and bitonic merge, Batcher 1968; use of registers, Knowles, Leach and Zambetta 2014
// (kplus_2015 [34]).
#define COMPARE(a, b) \
    if (block##b.x < block##a.x) { \
        FRAGMENT further = block##a; \
        block##a = block##b; \
        COUNT(moved, 2u) \
        block##b = further; }

// MERGEn sorts n fragments of which the first and the second half are sorted already; those at even and those at odd
// places are merged first.
#define MERGE4(a, b, c, d) COMPARE(a, c) COMPARE(b, d) COMPARE(b, c)
#define MERGE8(a, b, c, d, e, f, g, h) MERGE4(a, c, e, g) MERGE4(b, d, f, h) COMPARE(b, c) COMPARE(d, e) COMPARE(f, g)
#define MERGE16(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p) \
    MERGE8(a, c, e, g, i, k, m, o) MERGE8(b, d, f, h, j, l, n, p) COMPARE(b, c) COMPARE(d, e) COMPARE(f, g) \
    COMPARE(h, i) COMPARE(j, k) COMPARE(l, m) COMPARE(n, o)
#define MERGE32(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, A, B, C, D, E, F, G, H, I, J, K, L, M, N, O, P) \
    MERGE16(a, c, e, g, i, k, m, o, A, C, E, G, I, K, M, O) MERGE16(b, d, f, h, j, l, n, p, B, D, F, H, J, L, N, P) \
    COMPARE(b, c) COMPARE(d, e) COMPARE(f, g) COMPARE(h, i) COMPARE(j, k) COMPARE(l, m) COMPARE(n, o) COMPARE(p, A) \
    COMPARE(B, C) COMPARE(D, E) COMPARE(F, G) COMPARE(H, I) COMPARE(J, K) COMPARE(L, M) COMPARE(N, O)

#define SORT4(a, b, c, d) COMPARE(a, b) COMPARE(c, d) MERGE4(a, b, c, d)
#define SORT8(a, b, c, d, e, f, g, h) SORT4(a, b, c, d) SORT4(e, f, g, h) MERGE8(a, b, c, d, e, f, g, h)
#define SORT16(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p) \
    SORT8(a, b, c, d, e, f, g, h) SORT8(i, j, k, l, m, n, o, p) \
    MERGE16(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)
#define SORT32(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, A, B, C, D, E, F, G, H, I, J, K, L, M, N, O, P) \
    SORT16(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p) SORT16(A, B, C, D, E, F, G, H, I, J, K, L, M, N, O, P) \
    MERGE32(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, A, B, C, D, E, F, G, H, I, J, K, L, M, N, O, P)

// CLEANn sorts n fragments that are a bitonic sequence: increasing then decreasing, or reversed.
#define CLEAN4(a, b, c, d) COMPARE(a, c) COMPARE(b, d) COMPARE(a, b) COMPARE(c, d)
#define CLEAN8(a, b, c, d, e, f, g, h) \
    COMPARE(a, e) COMPARE(b, f) COMPARE(c, g) COMPARE(d, h) CLEAN4(a, b, c, d) CLEAN4(e, f, g, h)
#define CLEAN16(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p) \
    COMPARE(a, i) COMPARE(b, j) COMPARE(c, k) COMPARE(d, l) COMPARE(e, m) COMPARE(f, n) COMPARE(g, o) COMPARE(h, p) \
    CLEAN8(a, b, c, d, e, f, g, h) CLEAN8(i, j, k, l, m, n, o, p)
#define CLEAN32(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, A, B, C, D, E, F, G, H, I, J, K, L, M, N, O, P) \
    COMPARE(a, A) COMPARE(b, B) COMPARE(c, C) COMPARE(d, D) COMPARE(e, E) COMPARE(f, F) COMPARE(g, G) COMPARE(h, H) \
    COMPARE(i, I) COMPARE(j, J) COMPARE(k, K) COMPARE(l, L) COMPARE(m, M) COMPARE(n, N) COMPARE(o, O) COMPARE(p, P) \
    CLEAN16(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p) CLEAN16(A, B, C, D, E, F, G, H, I, J, K, L, M, N, O, P)

// EACHn(DO) expands to DO(0) … DO(n - 1), NEXT16 to the sixteen behind those, NEXT32 to the 32 of the second block.
#define EACH2(DO) DO(0) DO(1)
#define EACH4(DO) EACH2(DO) DO(2) DO(3)
#define EACH8(DO) EACH4(DO) DO(4) DO(5) DO(6) DO(7)
#define EACH16(DO) EACH8(DO) DO(8) DO(9) DO(10) DO(11) DO(12) DO(13) DO(14) DO(15)
#define NEXT16(DO) \
    DO(16) DO(17) DO(18) DO(19) DO(20) DO(21) DO(22) DO(23) DO(24) DO(25) DO(26) DO(27) DO(28) DO(29) DO(30) DO(31)
#define EACH32(DO) EACH16(DO) NEXT16(DO)
#define NEXT32(DO) \
    DO(32) DO(33) DO(34) DO(35) DO(36) DO(37) DO(38) DO(39) DO(40) DO(41) DO(42) DO(43) DO(44) DO(45) DO(46) DO(47) \
    DO(48) DO(49) DO(50) DO(51) DO(52) DO(53) DO(54) DO(55) DO(56) DO(57) DO(58) DO(59) DO(60) DO(61) DO(62) DO(63)

#define FIRST32(SORT) SORT(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, \
    16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31)
#define SECOND32(SORT) SORT(32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47, \
    48, 49, 50, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60, 61, 62, 63)

// OPPOSITE(DO) expands to DO(i, 63 - i) for each i of the first block.
#define OPPOSITE(DO) \
    DO(0, 63) DO(1, 62) DO(2, 61) DO(3, 60) DO(4, 59) DO(5, 58) DO(6, 57) DO(7, 56) DO(8, 55) DO(9, 54) DO(10, 53) \
    DO(11, 52) DO(12, 51) DO(13, 50) DO(14, 49) DO(15, 48) DO(16, 47) DO(17, 46) DO(18, 45) DO(19, 44) DO(20, 43) \
    DO(21, 42) DO(22, 41) DO(23, 40) DO(24, 39) DO(25, 38) DO(26, 37) DO(27, 36) DO(28, 35) DO(29, 34) DO(30, 33) \
    DO(31, 32)

#define DECLARE(i) FRAGMENT block##i;
#if NETWORK == 64
// Two blocks of 32: the including file sorts the parts that it needs.
EACH32(DECLARE)
NEXT32(DECLARE)
#elif NETWORK == 2
#define EACH(DO) EACH2(DO)
#define SORT_BLOCK COMPARE(0, 1)
#elif NETWORK == 4
#define EACH(DO) EACH4(DO)
#define SORT_BLOCK SORT4(0, 1, 2, 3)
#elif NETWORK == 8
#define EACH(DO) EACH8(DO)
#define SORT_BLOCK SORT8(0, 1, 2, 3, 4, 5, 6, 7)
#elif NETWORK == 16
#define EACH(DO) EACH16(DO)
#define SORT_BLOCK SORT16(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)
#else
#define EACH(DO) EACH32(DO)
#define SORT_BLOCK FIRST32(SORT32)
#endif
#if NETWORK < 64
EACH(DECLARE)
#endif

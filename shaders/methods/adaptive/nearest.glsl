// Resolve in sweeps over the pixel's fragments: each keeps the nearest 32 beyond the last sweep's in registers and
// composites them, until all are or no more than MAX_ERROR shows through.
// A block of 32 is sorted at a time; the nearer half of it and of what is kept is a bitonic sequence, which merges
// into order: no index varies and no array is needed.
// Invariant: a sweep takes fragments from the depth `from` on. Those of the furthest depth that it kept wait for the
// next, for not all of them may have been kept; if all 32 are of one depth, these are composited where they lie.
// Error: what is left out changes no channel by more than the transmittance before it, at most MAX_ERROR.
// Source: registers, Knowles, Leach and Zambetta 2014; batches of the nearest, kplus_2015 §4.4; merge, Batcher 1968.
#include "common/network.glsl"

#define LOAD(i) \
    block[32 + (i)] = NO_FRAGMENT; \
    if (at < end_cell) { \
        FRAGMENT fragment = nodes[at]; \
        if (fragment.x >= from) { \
            block[32 + (i)] = fragment; \
            ++met; \
        } \
    } \
    at += cell_step;
#define EMPTY_PLACE(i) block[i] = NO_FRAGMENT;
#define KEEP_NEARER(i) if (block[63 - (i)].x < block[i].x) block[i] = block[63 - (i)];
#define COMPOSITE(i) if (block[i].x < limit) colour = under(colour, colour_of(block[i]));
#define EACH32(DO) EACH16(DO, 0) EACH16(DO, 16)

#define APART4(a, s) COMPARE(a, (a) + (s)) COMPARE((a) + 1, (a) + 1 + (s)) \
    COMPARE((a) + 2, (a) + 2 + (s)) COMPARE((a) + 3, (a) + 3 + (s))
#define CLEAN4(a) COMPARE(a, (a) + 2) COMPARE((a) + 1, (a) + 3) COMPARE(a, (a) + 1) COMPARE((a) + 2, (a) + 3)
#define CLEAN8(a) APART4(a, 4) CLEAN4(a) CLEAN4((a) + 4)
#define CLEAN16(a) APART4(a, 8) APART4((a) + 4, 8) CLEAN8(a) CLEAN8((a) + 8)
#define CLEAN32(a) APART4(a, 16) APART4((a) + 4, 16) APART4((a) + 8, 16) APART4((a) + 12, 16) \
    CLEAN16(a) CLEAN16((a) + 16)

// Leaves the nearest 32 fragments from the depth `from` on in block[0 .. 32), nearest first; gives their number and
// that of the fragments behind them.
uint sweep(uint from) {
    uint met = 0u;
    EACH32(EMPTY_PLACE)
    for (uint at = first_cell; at < end_cell;) {
        EACH32(LOAD)
        SORT16(32)
        SORT16(48)
        MERGE32(32)
        EACH32(KEEP_NEARER)
        CLEAN32(0)
    }
    return met;
}

vec4 composite_alike(vec4 colour, uint depth) {
    for (uint at = first_cell; at < end_cell; at += cell_step) {
        FRAGMENT fragment = nodes[at];
        if (fragment.x == depth) colour = under(colour, colour_of(fragment));
    }
    return colour;
}

vec4 resolve_pixel() {
    vec4 colour = vec4(0.0);
    uint from = 0u;
    bool more = first_cell < end_cell;
    while (more) {
        more = sweep(from) > 32u;
        uint limit = more ? block[31].x : EMPTY;
        EACH32(COMPOSITE)
        if (more && block[0].x == limit) {
            colour = composite_alike(colour, limit);
            ++limit;
        }
        from = limit;
        more = more && 1.0 - colour.a > MAX_ERROR;
    }
    return colour;
}

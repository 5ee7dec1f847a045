// Resolves a pixel with many fragments in sweeps: each sweep keeps, in registers, the nearest 32 fragments beyond those
// of the previous sweep and composites them, until none is left or no more than MAX_ERROR of the light shows through. A
// sweep sorts one block of 32 at a time; the nearer half of this block and of the kept ones is a bitonic sequence,
// which is merged into order without variable indices and without an array.
// Invariant: a sweep takes fragments from the depth `from` on. Fragments at the furthest depth that it kept are left to
// the next sweep, because there may be more of them than were kept; if all 32 have one depth, they are composited in
// place.
// Error: omitted fragments change no channel by more than the transmittance before them, which is at most MAX_ERROR.
// Source: use of registers, Knowles, Leach and Zambetta 2014; batches of the nearest, kplus_2015 §4.4; merge, Batcher
// 1968.
// Buffers: updates nodes.
#include "common/network.glsl"

#define MERGED 32u  // most blocks that are merged in place
#define SWEEPS 3.0  // from this many sweeps on, merging takes less time

#define LOAD(i) \
    block##i = NO_FRAGMENT; \
    if (at < end_cell) { \
        FRAGMENT fragment = nodes_at(at); \
        if (fragment.x >= from) { \
            block##i = fragment; \
            ++met; \
        } \
    } \
    at += STEP(i);
#define EMPTY_PLACE(i) block##i = NO_FRAGMENT;
#define KEEP_NEARER(a, b) if (block##b.x < block##a.x) block##a = block##b;
#define PUT_BACK(i) if (at < end_cell) nodes[at] = block##i; at += STEP(i);
#define COMPOSITE(i) if (block##i.x < limit) colour = behind_of(colour, colour_of(block##i));

// Leaves the nearest 32 fragments with a depth of at least `from` in block0 to block31, nearest first. Returns the
// number of all fragments with such a depth.
uint sweep(uint from) {
    uint met = 0u;
    EACH32(EMPTY_PLACE)
    for (uint at = first_cell; at < end_cell;) {
        NEXT32(LOAD)
        SECOND32(SORT32)
        OPPOSITE(KEEP_NEARER)
        FIRST32(CLEAN32)
    }
    return met;
}

vec4 composite_alike(vec4 colour, uint depth) {
    for (uint slot = 0u, at = first_cell; at < end_cell; at = cell_of(++slot)) {
        FRAGMENT fragment = nodes_at(at);
        if (fragment.x == depth) colour = behind_of(colour, colour_of(fragment));
    }
    return colour;
}

// Tells whether, if all fragments were like the first eight, more than MAX_ERROR of the light would still show through
// after SWEEPS sweeps.
bool faint() {
    float through = 1.0;
    uint at = first_cell;
    for (uint i = 0u; i < 8u && at < end_cell; at = cell_of(++i)) through *= 1.0 - colour_of(nodes_at(at)).a;
    return pow(through, 4.0 * SWEEPS) > MAX_ERROR;
}

// Sorts each block in place, then repeatedly composites the nearest of the blocks' first remaining fragments.
vec4 merge() {
    const uint from = 0u;
    vec4 colour = NOTHING;
    uint heads[MERGED], depths[MERGED], blocks = 0u;
    for (uint start = first_cell; start < end_cell; start = cell_of(32u * blocks)) {
        uint at = start, met = 0u;
        NEXT32(LOAD)
        SECOND32(SORT32)
        at = start;
        NEXT32(PUT_BACK)
        heads[blocks] = 32u * blocks;
        depths[blocks++] = block32.x;
    }
    while (colour.a > MAX_ERROR) {
        uint depth = EMPTY, nearest = 0u;
        for (uint b = 0u; b < blocks; ++b) {
            if (depths[b] >= depth) continue;
            depth = depths[b];
            nearest = b;
        }
        if (depth == EMPTY) break;
        colour = behind_of(colour, colour_of(nodes[cell_of(heads[nearest])]));
        uint at = cell_of(++heads[nearest]);
        bool ended = (heads[nearest] & 31u) == 0u || at >= end_cell;
        depths[nearest] = ended ? EMPTY : nodes[at].x;
    }
    return colour;
}

vec4 resolve_pixel() {
    vec4 colour = NOTHING;
    uint from = 0u;
    if (cells_in_use(place()) <= 32u * MERGED && faint()) return merge();
    bool more = first_cell < end_cell;
    while (more) {
        more = sweep(from) > 32u;
        uint limit = more ? block31.x : EMPTY;
        EACH32(COMPOSITE)
        if (more && block0.x == limit) {
            colour = composite_alike(colour, limit);
            ++limit;
        }
        from = limit;
        more = more && colour.a > MAX_ERROR;
    }
    return colour;
}

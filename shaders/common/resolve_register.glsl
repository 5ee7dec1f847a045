// Register-block sort: sorts blocks of NETWORK fragments in registers. A single block is composited directly from the
// registers; several blocks are written back to the local array and merged while they are composited.
// Invariant: block b is at fragments[b * NETWORK], sorted and padded with empty fragments, which have no colour.
// Source: Knowles, Leach and Zambetta 2014 (kplus_2015 [34]).
#include "common/accumulate.glsl"
#include "common/network.glsl"
#include "common/enough.glsl"

// A fetch without FETCH_COUNT contains a loop, which is too much code to repeat for every register: its fragments, and
// those that are selected, are gathered in the local array first.
#if SELECT || !defined(FETCH_COUNT)
#define GATHERED 1
#include "common/gather.glsl"

uint gathered;

void source_begin(uint p) {
    gathered = gather(p);
}

#define LOAD(i) \
    block##i = NO_FRAGMENT; \
    if (base + uint(i) < gathered) block##i = fragments[base + uint(i)];

// Sorts the block of fragments from `base` on in registers.
void sort_block(uint base) {
    EACH(LOAD)
    SORT_BLOCK
}

// Tells whether there are fragments from `base` on.
bool more_from(uint base) {
    return base < gathered;
}

void count_lost() {}  // gather has counted them
#else
#define GATHERED 0
#define source_begin fetch_begin
#define LOAD(i) \
    found = found && fetch_next(fragment); \
    block##i = found ? fragment : NO_FRAGMENT;

bool found;

// Sorts the next block of fragments in registers.
void sort_block(uint base) {
    FRAGMENT fragment;
    found = true;
    EACH(LOAD)
    SORT_BLOCK
}

// Tells whether there may be fragments behind the last block.
bool more_from(uint base) {
    return found;
}

void count_lost() {
    uint lost = 0u;
    FRAGMENT fragment;
    while (fetch_next(fragment)) ++lost;
    if (lost > 0u) atomicAdd(lost_fragments, lost);
}
#endif

#if LOCAL == NETWORK

#define COMPOSITE(i) colour = onto(colour, colour_of(block##i));

vec4 resolve_pixel(uint p) {
    source_begin(p);
    vec4 colour = nothing_yet();
    sort_block(0u);
    if (more_from(uint(NETWORK))) count_lost();
    EACH(COMPOSITE)
    return composited(colour);
}

#else

#if !GATHERED
FRAGMENT fragments[LOCAL];
#endif

#define KEEP_BLOCK(i) fragments[base + uint(i)] = block##i;

// Returns where the blocks end. A block is stored before anything is compared with the next base, where llvmpipe 22.3.6
// may store it otherwise (docs/drivers.md).
uint sort_blocks() {
    uint base = 0u;
    do {
        sort_block(base);
        EACH(KEEP_BLOCK)
        base += uint(NETWORK);
    } while (base < uint(LOCAL) && more_from(base));
    if (more_from(base)) count_lost();
    return base;
}

vec4 resolve_pixel(uint p) {
    source_begin(p);
    uint end = sort_blocks();
    uint heads[LOCAL / NETWORK];  // number of fragments already composited, per block
    for (uint b = 0u; b < uint(LOCAL / NETWORK); ++b) heads[b] = 0u;
    vec4 colour = nothing_yet();
    while (true) {
        uint nearest = EMPTY, from = 0u;
        for (uint b = 0u; b * uint(NETWORK) < end; ++b) {
            if (heads[b] >= uint(NETWORK)) continue;
            uint depth = fragments[b * uint(NETWORK) + heads[b]].x;
            if (depth < nearest) {
                nearest = depth;
                from = b;
            }
        }
        if (nearest == EMPTY) break;
        colour = onto(colour, colour_of(fragments[from * uint(NETWORK) + heads[from]++]));
        if (enough(colour)) break;
    }
    return composited(colour);
}

#endif

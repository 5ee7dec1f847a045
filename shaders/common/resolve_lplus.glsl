// l+-depth-sorting: selects the nearest LOCAL fragments beyond the previous batch, sorts and composites them, and
// repeats. The local array stays short, at the price of reading all fragments once per batch.
// Invariant: every fragment is in exactly one batch; fragments that equal the boundary in depth and payload are
// counted. Fragments left over because the driver limits iterations are counted as lost, as in
// common/resolve_local.glsl.
// Source: kplus_2015 §4.4, Alg. 4, which loses fragments of equal depth at a boundary.
#define BATCHES 1
#include "common/accumulate.glsl"
#include "common/local.glsl"
#include "common/sort.glsl"
#include "common/enough.glsl"

// The furthest fragment composited so far, and how many fragments equal to it were composited.
FRAGMENT boundary;
uint repeats;

// Offers the fragments beyond the boundary to the selection; returns their number.
uint choose_batch(uint p, uint room) {
    uint offered = 0u, before = repeats;
    FRAGMENT fragment;
    for (fetch_begin(p); fetch_next(fragment);) {
        if (beyond(boundary, fragment)) continue;
        if (fragment == boundary && before > 0u) {
            --before;
            continue;
        }
        offer(fragment, offered++, room);
    }
    return offered;
}

// Moves the boundary to the furthest fragment of a full batch, which is in element 0.
void move_boundary(uint count) {
    if (fragments[0] != boundary) repeats = 0u;
    boundary = fragments[0];
    for (uint i = 0u; i < count; ++i)
        if (fragments[i] == boundary) ++repeats;
}

vec4 resolve_pixel(uint p) {
    vec4 colour = nothing_yet();
    boundary = FIRST_FRAGMENT;
    repeats = 0u;
    uint done = 0u, expected = 0u, offered, room;
    do {
        room = min(uint(LOCAL), uint(KEEP) - done);
        offered = choose_batch(p, room);
        uint count = min(offered, room);
        if (offered > room) move_boundary(count);
        if (done == 0u) expected = min(offered, uint(KEEP));
        sort_fragments(count);
        uint i = 0u;
        for (; i < count; ++i) {
            colour = onto(colour, colour_of(fragments[i]));
            if (enough(colour)) break;
        }
        done += i;
    } while (offered > room && done < uint(KEEP) && !enough(colour));
    if (done < expected && !enough(colour)) atomicAdd(lost_fragments, expected - done);
    return composited(colour);
}

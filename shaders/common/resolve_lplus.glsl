// l+-depth-sorting: selects the nearest LOCAL fragments that are not composited yet, sorts and composites them, and
// repeats. The local array stays short, at the price of reading all fragments once per batch.
// Invariant: a batch ends before the nearest depth that is left out of it, so that no depth is in two batches, and
// depths alone tell which fragments are left. A depth of more than LOCAL fragments needs no sort. Fragments left over
// because the driver limits iterations are counted as lost, as in common/resolve_local.glsl.
// Source: kplus_2015 §4.4, Alg. 4, which loses fragments of equal depth at a boundary.
#include "common/accumulate.glsl"
#include "common/nearest.glsl"
#include "common/sort.glsl"
#include "common/enough.glsl"

// Composites at most `room` fragments of one depth; returns their number.
uint composite_depth(uint p, uint depth, uint room, inout vec4 colour) {
    uint done = 0u;
    FRAGMENT fragment;
    for (fetch_begin(p); fetch_next(fragment) && done < room && !enough(colour);) {
        if (fragment.x != depth) continue;
        colour = onto(colour, colour_of(fragment));
        ++done;
    }
    return done;
}

// Composites the fragments of the sorted batch that are nearer than `until`; returns their number.
uint composite_batch(uint count, uint until, inout vec4 colour) {
    uint i = 0u;
    for (; i < count && fragments[i].x < until; ++i) {
        colour = onto(colour, colour_of(fragments[i]));
        if (enough(colour)) break;
    }
    return i;
}

vec4 resolve_pixel(uint p) {
    vec4 colour = nothing_yet();
    uint from = 0u, done = 0u, expected = 0u, offered, left, room;
    do {
        room = min(uint(LOCAL), uint(KEEP) - done);
        offered = select_nearest(p, from, room, left);
        if (done == 0u) expected = min(offered, uint(KEEP));
        uint count = min(offered, room);
        sort_fragments(count);
        uint composited_now = composite_batch(count, done + count < uint(KEEP) ? left : EMPTY, colour);
        from = left;
        if (composited_now == 0u) composited_now = composite_depth(p, from++, uint(KEEP) - done, colour);
        done += composited_now;
    } while (offered > room && done < uint(KEEP) && !enough(colour));
    if (done < expected && !enough(colour)) atomicAdd(lost_fragments, expected - done);
    return composited(colour);
}

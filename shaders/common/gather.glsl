// Copies the fragments of a pixel into the local array and returns their number. With SELECT only the nearest KEEP are
// copied (kplus_2015 §3.3, §5.1.1). A fragment that should be in the array but finds no room is counted as lost.
#include "common/local.glsl"
#if SELECT
#include "common/nearest.glsl"
#endif

uint gather(uint p) {
    const uint room = uint(min(LOCAL, KEEP));
#if SELECT
    uint left;
    uint seen = min(select_nearest(p, 0u, room, left), uint(KEEP));
#else
    uint seen = 0u;
    FRAGMENT fragment;
    for (fetch_begin(p); seen < room && fetch_next(fragment); ++seen) fragments[seen] = fragment;
    if (seen == room) while (fetch_next(fragment)) ++seen;
#endif
    uint kept = min(seen, room);
    if (seen > kept) atomicAdd(lost_fragments, seen - kept);
    return kept;
}

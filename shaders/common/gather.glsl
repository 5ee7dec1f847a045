// Copies the fragments of a pixel into the local array and returns their number. With SELECT only the nearest KEEP are
// copied (kplus_2015 §3.3, §5.1.1). A fragment that should be in the array but finds no room is counted as lost.
#include "common/local.glsl"

uint gather(uint p) {
    const uint room = uint(min(LOCAL, KEEP));
    uint seen = 0u;
    FRAGMENT fragment;
    for (fetch_begin(p); fetch_next(fragment); ++seen) {
#if SELECT
        offer(fragment, seen, room);
#else
        if (seen < room) fragments[seen] = fragment;
#endif
    }
    uint kept = min(seen, room);
#if SELECT
    seen = min(seen, uint(KEEP));
#endif
    if (seen > kept) atomicAdd(lost_fragments, seen - kept);
    return kept;
}

// Copies the pixel's fragments into the local array, or with SELECT the nearest KEEP of them, and gives their number
// (kplus_2015 §3.3, §5.1.1). A fragment that belongs there and finds no room is lost, and counted.
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

// Depth bounds for linked lists by depth range: finds the nearest and the furthest depth of each pixel by atomics.
// MAXIMUM_COMPARE_AND_SWAP emulates the atomic minimum and maximum by compare-and-swap, as gpupro5_ch1 §1.6 does to
// estimate their cost: a swap that finds another value retries with that value, until its own is no longer better.
// Source: Vasilakis and Fudos 2013 (AB_LL-BUN), as in kplus_2015 §2.
// Buffers: updates nearest, furthest.
#include "scene/fragment.glsl"
#include "common/helper.glsl"

#if MAXIMUM_COMPARE_AND_SWAP
#define EMULATED(bound, better) { \
    uint seen = bound; \
    bool going = !IS_HELPER && depth better seen; \
    for (uint tries = 0u; going && tries < uint(LOCK_TRIES); ++tries) { \
        uint found = atomicCompSwap(bound, seen, depth); \
        going = found != seen && depth better found; \
        seen = found; \
    } \
    if (going) atomicAdd(lost_fragments, 1u); \
}
#define LOWER_TO(bound) EMULATED(bound, <)
#define RAISE_TO(bound) EMULATED(bound, >)
#else
#define LOWER_TO(bound) atomicMin(bound, depth);
#define RAISE_TO(bound) atomicMax(bound, depth);
#endif

void main() {
    if (rejected()) discard;
    uint p = pixel_index(), depth = incoming().x;
    LOWER_TO(nearest[p])
    RAISE_TO(furthest[p])
}

// Reads the fragments of one of a pixel's lists. FETCH_COUNT is the length of the longest list of the pixel, because
// the local array of the resolve needs room for that many fragments.
#include "methods/list/fetch.glsl"

#define FETCH_COUNT(p) longest_list(p)

uint longest_list(uint p) {
    uint longest = 0u;
    FRAGMENT fragment;
    for (uint bucket = 0u; bucket < uint(BUCKETS); ++bucket) {
        uint count = 0u;
        for (fetch_begin(bucket * pixels + p); fetch_next(fragment);) ++count;
        longest = max(longest, count);
    }
    return longest;
}

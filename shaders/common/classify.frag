// Backwards memory allocation: the class of each pixel becomes its depth, so that the depth test picks the pixels
// of each resolve; the image is cleared for those without fragments.
// Source: Knowles, Leach and Zambetta 2013 (kplus_2015 [38]).
#include "common/pixel.glsl"
#include "common/pixel_class.glsl"
#include <fetch>

uint fragment_count(uint p) {
#ifdef FETCH_COUNT
    return FETCH_COUNT(p);
#else
    uint count = 0u;
    FRAGMENT fragment;
    for (fetch_begin(p); fetch_next(fragment);) ++count;
    return count;
#endif
}

void main() {
    uint count = min(fragment_count(pixel_index()), uint(KEEP));
    int index = count <= 8u ? 0 : min(findMSB(count - 1u) - 2, LAST_CLASS);
    out_image = vec4(0.0);
    gl_FragDepth = CLASS_DEPTH(count == 0u ? NO_CLASS : index);
}

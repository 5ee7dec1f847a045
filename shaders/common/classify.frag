// Backwards memory allocation: writes the class of each pixel as its depth, so that the depth test then selects the
// pixels of each resolve pass. Pixels without fragments get NO_CLASS. The pass also clears the image, which no resolve
// pass writes in those pixels.
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

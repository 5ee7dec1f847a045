// Composites a pixel's fragments as its fetch reads them, nearest first.
#include "common/enough.glsl"

vec4 composite_sorted(uint p) {
    vec4 colour = vec4(0.0);
    FRAGMENT fragment;
    for (fetch_begin(p); !enough(colour) && fetch_next(fragment);) colour = under(colour, colour_of(fragment));
    return colour;
}

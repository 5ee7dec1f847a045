// Composites the fragments of a pixel in the order in which the method's fetch returns them, which is nearest first.
#include "common/accumulate.glsl"
#include "common/enough.glsl"

vec4 composite_sorted(uint p) {
    vec4 colour = nothing_yet();
    FRAGMENT fragment;
    for (fetch_begin(p); fetch_next(fragment);) {
        colour = onto(colour, colour_of(fragment));
        if (enough(colour)) break;
    }
    return composited(colour);
}

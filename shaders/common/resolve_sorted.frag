// Resolve of fragments that already come nearest first: composites them as they are read.
#include "common/pixel.glsl"
#include "common/colour.glsl"
#include <fetch>

layout(early_fragment_tests) in;

void main() {
    vec4 colour = vec4(0.0);
    uvec2 fragment;
    for (fetch_begin(pixel_index()); fetch_next(fragment);) colour = under(colour, premultiplied(fragment.y));
    out_image = colour;
}

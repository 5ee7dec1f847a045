// Resolve as a full-screen draw, for every pixel, or for the pixels of one class if the depth test selects them. The
// method's fetch reads the fragments, and its resolver turns them into one colour.
#include "common/pixel.glsl"
#include "common/colour.glsl"
#include <fetch>
#include <resolver>
#include "common/resolve_lists.glsl"

void main() {
    out_image = resolve_lists(pixel_index());
    COUNT(empty, out_image.a == 0.0)
}

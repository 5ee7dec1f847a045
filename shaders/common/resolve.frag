// Resolve of every pixel by a full-screen draw, or of one class of pixels by the depth test.
#include "common/pixel.glsl"
#include "common/colour.glsl"
#include <fetch>
#include <resolver>
#include "common/resolve_lists.glsl"

void main() {
    out_image = resolve_lists(pixel_index());
    COUNT(empty, out_image.a == 0.0)
}

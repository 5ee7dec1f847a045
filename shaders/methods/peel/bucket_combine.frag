// Bucket peeling, end: the buckets from the nearest to the furthest, the front layers of each over its back layers.
#include "common/pixel.glsl"
#include "common/transmittance.glsl"

void main() {
    uint p = pixel_index();
    vec4 colour = NOTHING;
    for (uint half_bucket = 0u; half_bucket < 2u * uint(BUCKETS); ++half_bucket)
        colour = stacked(colour, layers[half_bucket * pixels + p]);
    out_image = with_opacity(colour);
}

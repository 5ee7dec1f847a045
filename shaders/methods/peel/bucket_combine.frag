// Last pass of bucket peeling: composites the buckets from the nearest to the furthest, in each the front layers over
// the back layers.
// Buffers: reads layers.
#include "common/pixel.glsl"
#include "common/transmittance.glsl"

void main() {
    uint p = pixel_index();
    vec4 colour = NOTHING;
    for (uint half_bucket = 0u; half_bucket < 2u * uint(BUCKETS); ++half_bucket)
        colour = stacked(colour, layers[half_bucket * pixels + p]);
    out_image = with_opacity(colour);
}

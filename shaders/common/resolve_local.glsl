// Resolve in one local array: gathers the pixel's fragments, sorts them, composites front to back.
// A driver that bounds the iterations of a shader (llvmpipe: 65,535) ends the loops early where a quadratic sort has
// some 360 fragments: what is not composited counts as lost.
#define BATCHES 0
#include "common/gather.glsl"
#include "common/sort.glsl"

vec4 resolve_pixel(uint p) {
    uint count = gather(p);
    sort_fragments(count);
    vec4 colour = vec4(0.0);
    uint i = 0u;
    for (; i < count; ++i) colour = under(colour, colour_of(fragments[i]));
    if (i < count) atomicAdd(lost_fragments, count - i);
    return colour;
}

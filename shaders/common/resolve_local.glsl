// Resolves a pixel in one local array: gathers its fragments, sorts them and composites them front to back. A driver
// that limits the iterations of a shader (llvmpipe: 65,535) ends the loops of a quadratic sort early from about 360
// fragments on; the fragments that are then not composited are counted as lost.
#include "common/accumulate.glsl"
#include "common/gather.glsl"
#include "common/sort.glsl"
#include "common/enough.glsl"

vec4 resolve_pixel(uint p) {
    uint count = gather(p);
    sort_fragments(count);
    vec4 colour = nothing_yet();
    uint i = 0u;
    for (; i < count; ++i) {
        colour = onto(colour, colour_of(fragments[i]));
        if (enough(colour)) break;
    }
    if (i < count && !enough(colour)) atomicAdd(lost_fragments, count - i);
    return composited(colour);
}

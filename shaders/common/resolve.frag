// Resolve: copies the pixel's fragments into local memory, sorts them, composites front to back.
// With SELECT the LOCAL nearest are kept, the furthest of them in slot 0 (kplus_2015 §3.3, §5.1.1);
// without it a fragment that finds no room is lost, and counted.
#include "common/pixel.glsl"
#include "common/colour.glsl"
#include "common/sort.glsl"
#include <fetch>



#if SELECT
void furthest_to_front(uint count) {
    uint furthest = 0u;
    for (uint i = 1u; i < count; ++i)
        if (fragments[i].x > fragments[furthest].x) furthest = i;
    uvec2 swapped = fragments[0];
    fragments[0] = fragments[furthest];
    fragments[furthest] = swapped;
}
#endif

uint gather(uint p) {
    uint count = 0u;
    uvec2 fragment;
    for (fetch_begin(p); fetch_next(fragment);) {
        if (count < uint(LOCAL)) {
            fragments[count++] = fragment;
#if SELECT
            if (count == uint(LOCAL)) furthest_to_front(count);
        } else if (fragment.x < fragments[0].x) {
            fragments[0] = fragment;
            furthest_to_front(count);
#else
        } else {
            atomicAdd(lost_fragments, 1u);
#endif
        }
    }
    return count;
}

void main() {
    uint count = gather(pixel_index());
    sort_fragments(count);
    vec4 colour = vec4(0.0);
    for (uint i = 0u; i < count; ++i) colour = under(colour, premultiplied(fragments[i].y));
    out_image = colour;
}

// Resolve of fragments in the framebuffer: composites the sorted fragments of each pixel of the region. With ASKS a pixel
// that had more fragments than places tells so: one more than there are is the least that the next frame needs.
// Buffers: updates deepest.
#include "common/colour.glsl"
#include "common/transmittance.glsl"
#define EIGHTH_PLACE texelFetch(kept_7, ivec2(gl_FragCoord.xy), 0)
#include "methods/adaptive/places.glsl"
#include "methods/adaptive/overfull.glsl"

#define COMPOSITE(place) colour = behind_of(colour, colour_of(FRAGMENT(place.xy)));

void main() {
    vec4 colour = NOTHING;
    EACH_PLACE(COMPOSITE)
    out_image = with_opacity(colour);
#if ASKS
    uint last = LAST_PLACE.x;
    if (last >= OVERFULL && last != EMPTY) atomicMax(deepest[0], uint(LAYERS) + 1u);
#endif
    COUNT(empty, out_kept_0.x == EMPTY)
}

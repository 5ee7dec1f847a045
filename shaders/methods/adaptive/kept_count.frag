// Counts the fragments that each pixel has in the framebuffer. This pass runs outside timed frames.
#define EIGHTH_PLACE texelFetch(kept_7, ivec2(gl_FragCoord.xy), 0)
#include "methods/adaptive/places.glsl"

#define ADD(place) if (place.x != EMPTY) ++count;

void main() {
    uint count = 0u;
    EACH_PLACE(ADD)
    if (count > 0u) atomicAdd(stored_fragments, count);
}

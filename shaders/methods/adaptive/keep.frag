// Store in the framebuffer: each fragment is inserted among those of its pixel, which are sorted from the nearest on.
// Framebuffer fetch gives a fragment the places as the one before has left them, so that no lock is needed.
// Invariant: an empty place has the depth EMPTY, behind every fragment. Where a pixel has more fragments than places, the
// furthest are lost, and the last place has OVERFULL in its depth, which is the sign of a float; depths have none.
// A rejected fragment leaves its places as they are: to discard it would cost llvmpipe more than half of the pass.
// Source: insertion while blending, Bavoil et al. 2007 (k-buffer); GL_EXT_shader_framebuffer_fetch.
#include "scene/fragment.glsl"
#define EIGHTH_PLACE out_kept_7
#include "methods/adaptive/places.glsl"
#include "methods/adaptive/overfull.glsl"

#define INSERT(place) { \
    FRAGMENT held = place.xy; \
    bool before = fragment.x < held.x; \
    place.xy = before ? fragment : held; \
    fragment = before ? held : fragment; }

void main() {
    if (rejected()) return;
    FRAGMENT fragment = incoming();
    EACH_PLACE(INSERT)
    if (fragment.x != EMPTY) LAST_PLACE.x |= OVERFULL;
}

// Puts an effect in the place of transparency. It stands behind common/accumulate.glsl in resolves of scenes with
// another effect: a resolve then hands whole fragments on, nearest first, where it would composite their colours.
// Invariant: a fragment of depth EMPTY, by which a sorting network fills its block, reaches no effect.
#include "effects/fragment.glsl"
#include <effect>

vec4 add_fragment(vec4 state, FRAGMENT fragment) {
    return fragment.x == EMPTY ? state : effect_add(state, fragment);
}

#define nothing_yet effect_begin
#define onto add_fragment
#define composited effect_end
#define colour_of(fragment) fragment
#define opacity_so_far(state) 0.0

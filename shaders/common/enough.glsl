// Tells whether compositing a pixel may stop: the fragments that are left can change no channel by more than 1 -
// STOP_OPACITY. `colour` is an accumulator of common/accumulate.glsl. With STOP_OPACITY = 1 this is constantly false,
// and a loop with `if (enough(colour)) break;` compiles to a loop without the test.
#include "common/accumulate.glsl"

bool enough(vec4 colour) {
    return STOP_OPACITY < 1.0 && opacity_so_far(colour) >= STOP_OPACITY;
}

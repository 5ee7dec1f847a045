// Whether the compositing of a pixel ends: what is still behind can change no channel by more than 1 - STOP_OPACITY.
// `colour` is an accumulated one. As a statement of its own in a loop it leaves nothing behind where nothing stops.
#include "common/accumulate.glsl"

bool enough(vec4 colour) {
    return STOP_OPACITY < 1.0 && opacity_so_far(colour) >= STOP_OPACITY;
}

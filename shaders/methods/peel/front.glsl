// Converts a front colour of dual peeling for MAX blending and back (the function is its own inverse). Under MAX
// blending a channel can only increase, whereas transmittance decreases; it is therefore stored negated.
#include "common/transmittance.glsl"

vec4 in_front(vec4 colour) {
    return vec4(colour.rgb, -colour.a);
}

// The front colours of dual peeling are kept by MAX blending, so they may only grow: the transmittance stands there
// negated. Its own inverse.
#include "common/transmittance.glsl"

vec4 in_front(vec4 colour) {
    return vec4(colour.rgb, -colour.a);
}

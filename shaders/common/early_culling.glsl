// Early culling drops a fragment that lies behind an accumulated opacity of CULLING_OPACITY. The error is at most 1 -
// CULLING_OPACITY.
// Source: gpupro5_ch1 §1.4.2, §1.7.2.
#include "common/colour.glsl"

float covered(float opacity, PAYLOAD payload) {
    return opacity + (1.0 - opacity) * premultiplied(payload).a;
}

// Early culling: a fragment behind an accumulated opacity of OPAQUE is dropped, at an error of 1 - OPAQUE at most.
// Source: gpupro5_ch1 §1.4.2, §1.7.2.
#include "common/colour.glsl"

const float OPAQUE = 0.95;

float covered(float opacity, PAYLOAD payload) {
    return opacity + (1.0 - opacity) * premultiplied(payload).a;
}

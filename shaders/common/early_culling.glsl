// Early culling: a fragment behind an accumulated opacity of CULLING_OPACITY is dropped, at an error
// of 1 - CULLING_OPACITY at most.
// Source: gpupro5_ch1 §1.4.2, §1.7.2.
#include "common/colour.glsl"

float covered(float opacity, PAYLOAD payload) {
    return opacity + (1.0 - opacity) * premultiplied(payload).a;
}

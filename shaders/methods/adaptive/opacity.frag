// Optical depth of the first and of the second half of the depths before FURTHEST_CUT, added up by blending: in each channel 1/16 bit
// of transmittance per unit. Early z discards what lies behind.
// Invariant: rounded down and saturating at 255 units, so that never more opacity is seen than there is.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    float bits = -log2(max(1.0 - float(payload8 >> 24) / 255.0, 1.0 / 65536.0));
    float units = floor(bits * 15.99) / 255.0;
    out_opacity = gl_FragCoord.z < FURTHEST_CUT / 2.0 ? vec4(units, 0.0, 0.0, 0.0) : vec4(0.0, units, 0.0, 0.0);
}

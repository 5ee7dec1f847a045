// Adds up, by blending, the optical depth of the first and of the second half of the depths before FURTHEST_CUT. One
// unit of a channel stands for 1/16 bit of transmittance. Early z discards fragments behind FURTHEST_CUT.
// Invariant: each fragment is rounded down and the sum saturates at 255 units, so the opacity is never overestimated.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    float bits = -log2(max(1.0 - float(payload8 >> 24) / 255.0, 1.0 / 65536.0));
    float units = floor(bits * 15.99) / 255.0;
    out_opacity = gl_FragCoord.z < FURTHEST_CUT / 2.0 ? vec4(units, 0.0, 0.0, 0.0) : vec4(0.0, units, 0.0, 0.0);
}

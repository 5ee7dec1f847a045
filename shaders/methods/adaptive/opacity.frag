// Optical depth by quarter of the depth range, added up by blending: in each channel 1/16 bit of transmittance per unit.
// Invariant: rounded down and saturating at 255 units, so that never more opacity is seen than there is.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    float bits = -log2(max(1.0 - float(payload8 >> 24) / 255.0, 1.0 / 65536.0));
    vec4 units = vec4(0.0);
    units[min(uint(gl_FragCoord.z * 4.0), 3u)] = floor(bits * 15.99) / 255.0;
    out_opacity = units;
}

// Optical depth by quarter of the depth range, added up by blending: in each channel 1/16 bit of transmittance per unit.
// That of the last quarter is not asked for.
// Invariant: rounded down and saturating at 255 units, so that never more opacity is seen than there is.
#include "scene/fragment.glsl"

void main() {
    if (rejected() || gl_FragCoord.z >= 0.75) discard;
    float bits = -log2(max(1.0 - float(payload8 >> 24) / 255.0, 1.0 / 65536.0));
    bvec4 within = equal(uvec4(gl_FragCoord.z * 4.0), uvec4(0u, 1u, 2u, 3u));
    out_opacity = vec4(within) * (floor(bits * 15.99) / 255.0);
}

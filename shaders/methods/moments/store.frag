// First geometry pass of moment-based OIT: additive blending sums the absorbances of the fragments and their products
// with powers of depth.
// Invariant: layer i of `moments` contains the moments 2i + 1 and 2i + 2.
// Source: Muenstermann et al. 2018, §3.1.
#include "scene/fragment.glsl"
#include "common/colour.glsl"
#include "methods/moments/absorbance.glsl"

void main() {
    if (rejected()) discard;
    float z = moment_depth(gl_FragCoord.z), term = absorbance_of(colour_of(incoming()).a);
    out_absorbance = vec4(term);
    for (int layer = 0; layer < MOMENTS / 2; ++layer) {
        out_moments[layer] = vec4(term * z, term * z * z, 0.0, 0.0);
        term *= z * z;
    }
}

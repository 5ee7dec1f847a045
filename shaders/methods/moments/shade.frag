// Second geometry pass of moment-based OIT: each fragment adds its colour and alpha, attenuated by the transmittance
// that the reconstruction gives for its depth.
// Source: Muenstermann et al. 2018, §3.3.
#include "scene/fragment.glsl"
#include "common/colour.glsl"
#include "methods/moments/absorbance.glsl"
#include "methods/moments/reconstruct.glsl"

void main() {
    if (rejected()) discard;
    ivec2 xy = ivec2(gl_FragCoord.xy);
    float moment[MOMENTS + 1];
    moment[0] = texelFetch(absorbance, xy, 0).x;
    for (int layer = 0; layer < MOMENTS / 2; ++layer) {
        vec2 pair = texelFetch(moments, ivec3(xy, layer), 0).xy;
        moment[2 * layer + 1] = pair.x;
        moment[2 * layer + 2] = pair.y;
    }
    float before = moment[0] > 0.0 ? absorbance_before(moment_depth(gl_FragCoord.z), moment) : 0.0;
    out_shaded = colour_of(incoming()) * exp(-before);
}

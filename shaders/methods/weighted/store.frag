// Store of weighted blended OIT: additive blending sums the weighted premultiplied colours and the weighted alphas, and
// multiplicative blending computes the product of 1 - alpha.
// Source: McGuire and Bavoil 2013, §4, Eq. 6.
#include "scene/fragment.glsl"
#include "common/colour.glsl"
#include "methods/weighted/weight.glsl"

void main() {
    if (rejected()) discard;
    vec4 colour = colour_of(incoming());
    out_accumulation = colour * weight(gl_FragCoord.z, colour.a);
    out_revealage = vec4(colour.a);
}

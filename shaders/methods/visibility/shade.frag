// Second geometry pass of adaptive transparency: each fragment adds its colour, attenuated by the visibility function
// at its depth.
// Source: Salvi et al. 2011, §3, Eq. 3.
#include "scene/fragment.glsl"
#include "common/colour.glsl"
#include "methods/visibility/nodes.glsl"

void main() {
    if (rejected()) discard;
    FRAGMENT fragment = incoming();
    out_image = vec4(colour_of(fragment).rgb * visibility(pixel_index(), fragment.x), 0.0);
}

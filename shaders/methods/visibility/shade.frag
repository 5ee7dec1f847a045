// Adaptive transparency, second geometry pass: each fragment adds its colour, as far as the nodes let it be seen.
// Source: Salvi et al. 2011, §3, Eq. 3.
#include "scene/fragment.glsl"
#include "common/colour.glsl"
#include "methods/visibility/nodes.glsl"

void main() {
    if (rejected()) discard;
    FRAGMENT fragment = incoming();
    out_image = vec4(colour_of(fragment).rgb * visibility(pixel_index(), fragment.x), 0.0);
}

// Floor: fixed-function blending in submission order, the least that any method has to do.
#include "scene/fragment.glsl"
#include "common/colour.glsl"

void main() {
    if (rejected()) discard;
    out_image = colour_of(incoming());
}

// Blending floor: blends the fragments in submission order by fixed-function blending, which is the least work that any
// method has to do.
#include "scene/fragment.glsl"
#include "common/colour.glsl"

void main() {
    if (rejected()) discard;
    out_image = colour_of(incoming());
}

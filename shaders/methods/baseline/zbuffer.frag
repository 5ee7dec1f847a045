// Z-buffer: the hardware depth test keeps the nearest fragment (k-buffer with k = 1, kplus_2015 §4.3).
// Fragments of equal depth: the last submitted wins.
#include "scene/fragment.glsl"
#include "common/colour.glsl"

void main() {
    if (rejected()) discard;
    out_image = premultiplied(incoming().y);
}

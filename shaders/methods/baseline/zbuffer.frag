// Z-buffer: the hardware depth test keeps the nearest fragment, which is a k-buffer with k = 1 (kplus_2015 §4.3). Of
// fragments with equal depth the last submitted one is kept.
#include "scene/fragment.glsl"
#include "common/colour.glsl"

void main() {
    if (rejected()) discard;
    out_image = premultiplied(incoming().y);
}

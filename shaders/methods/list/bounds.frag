// Linked lists by depth range, bounds: the nearest and the furthest depth of each pixel.
// Source: Vasilakis and Fudos 2013 (AB_LL-BUN), as in kplus_2015 §2.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index(), depth = incoming().x;
    atomicMin(nearest[p], depth);
    atomicMax(furthest[p], depth);
}

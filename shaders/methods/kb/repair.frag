// Multi-pass k-buffer: fragments that belong to the K nearest and are not held are inserted as in the k-buffer; the
// depth test keeps the nearest of them for certain.
// Invariant: whoever is not held is further than all that the slots before its place hold, and writes only beyond:
// what is nearer than the nearest missing fragment stays. A pass in which none is missing writes nothing.
// Source: Liu et al. 2009, as in kplus_2015 §2 and Table 1.
#include "scene/fragment.glsl"
#include "methods/ps/slots.glsl"
#include "common/insert_sorted.glsl"

// A slot of the fragment's depth with another colour is torn, or holds another fragment of equal depth.
bool missing(uint p, FRAGMENT fragment) {
    for (uint slot = 0u; slot < uint(K); ++slot) {
        FRAGMENT held = read_slot(p, slot);
        if (held.x == fragment.x) return held.y != fragment.y;
        if (held.x > fragment.x) return true;
    }
    return false;
}

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    FRAGMENT fragment = incoming();
    if (!missing(p, fragment)) discard;
    out_layer = uvec4(fragment.y);
    insert_sorted(p, fragment);
}

// Store of the multi-pass k-buffer: a fragment that belongs to the K nearest but is not stored is inserted as in the
// k-buffer; in addition the depth test keeps the nearest of these missing fragments, without hazards.
// Invariant: a missing fragment is further than everything in the slots before its place and writes only from its place
// on, so slots nearer than the nearest missing fragment stay as they are. If none is missing, the pass writes nothing.
// Source: Liu et al. 2009, as in kplus_2015 §2 and Table 1.
#include "scene/fragment.glsl"
#include "methods/ps/slots.glsl"
#include "common/insert_sorted.glsl"

// A slot with the fragment's depth but another colour is torn, or belongs to another fragment of equal depth.
bool missing(uint p, FRAGMENT fragment) {
    for (uint slot = 0u; slot < BOUND; ++slot) {
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

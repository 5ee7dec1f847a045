// Store of one of several passes of the k-buffer: sorted insertion, without mutual exclusion, of the fragments that no
// pass before has composited.
// Invariant: fragments before first_depth[p] are in the image already, or had no slot beside their equals.
// Source: kplus_2015 §2; sbuffer_2012 §4.
// Buffers: reads first_depth.
#include "scene/fragment.glsl"
#include "methods/ps/slots.glsl"
#include "common/insert_sorted.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    FRAGMENT fragment = incoming();
    if (fragment.x < first_depth[p]) discard;
    insert_sorted(p, fragment);
}

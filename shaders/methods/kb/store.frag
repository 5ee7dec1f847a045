// Store of the k-buffer: sorted insertion without mutual exclusion. Concurrent fragments of one pixel may lose each
// other's moves; the result is right if the fragments of a pixel are shaded one by one.
// Source: Callahan et al. 2005; Bavoil et al. 2007; kplus_2015 §2.
#include "scene/fragment.glsl"
#include "methods/ps/slots.glsl"
#include "common/insert_sorted.glsl"

void main() {
    if (rejected()) discard;
    insert_sorted(pixel_index(), incoming());
}

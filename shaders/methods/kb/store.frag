// k-buffer, store: sorted insertion without any exclusion; fragments of one pixel in flight at once may lose
// each other's moves. Right where they come one by one.
// Source: Callahan et al. 2005; Bavoil et al. 2007; kplus_2015 §2.
#include "scene/fragment.glsl"
#include "methods/ps/slots.glsl"
#include "common/insert_sorted.glsl"

void main() {
    if (rejected()) discard;
    insert_sorted(pixel_index(), incoming());
}

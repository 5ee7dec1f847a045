// First geometry pass of adaptive transparency: builds the visibility function of each pixel in K nodes.
// Source: Salvi et al. 2011, §3.
#include "scene/fragment.glsl"
#include "common/colour.glsl"
#include "common/lock.glsl"
#include "methods/visibility/nodes.glsl"
#include "methods/ps/slots.glsl"
#include "common/insert_sorted.glsl"
#include "methods/visibility/compress.glsl"

void insert(uint p, FRAGMENT node) {
    FRAGMENT beyond = insert_sorted(p, node);
    if (beyond.x != EMPTY) compress(p, beyond);
}

void main() {
    uint p = pixel_index();
    FRAGMENT fragment = incoming();
    FRAGMENT node = FRAGMENT(fragment.x, floatBitsToUint(1.0 - colour_of(fragment).a));
    CRITICAL_BEGIN(p, !rejected())
    insert(p, node);
    CRITICAL_END(p)
}

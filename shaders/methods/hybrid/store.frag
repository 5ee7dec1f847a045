// Store of hybrid transparency: the K nearest fragments of the pixel stay sorted in the core; a fragment that falls out
// of the core is added to the sums of the tail.
// Invariant: every fragment so far is in the core or counted in the tail, and no fragment of the tail is nearer than
// one of the core.
// Source: Maule et al. 2013, §3.
// Buffers: updates tail, tail_count.
#include "scene/fragment.glsl"
#include "common/colour.glsl"
#include "common/lock.glsl"
#include "methods/ps/slots.glsl"
#include "common/insert_sorted.glsl"

void insert(uint p, FRAGMENT fragment) {
    FRAGMENT furthest = insert_sorted(p, fragment);
    if (furthest.x == EMPTY) return;
    tail[p] += colour_of(furthest);
    tail_count[p] += 1u;
}

void main() {
    uint p = pixel_index();
    FRAGMENT fragment = incoming();
    CRITICAL_BEGIN(p, !rejected())
    insert(p, fragment);
    CRITICAL_END(p)
}

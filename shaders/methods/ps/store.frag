// Store of KB-PS: inserts the fragment into K sorted slots, one fragment of a pixel at a time.
// Invariant: outside the critical section the slots are sorted, and the fragment of the last slot only gets nearer. An
// outdated value of it may let a fragment through, but never refuses one that belongs into the slots.
// Source: Salvi 2013; kplus_2015 §2; culling, kplus_2015 §5.1.1.
// Buffers: reads nodes.
#include "scene/fragment.glsl"
#include "common/lock.glsl"
#include "methods/ps/slots.glsl"
#include "common/insert_sorted.glsl"

void main() {
    uint p = pixel_index();
    uvec2 fragment = incoming();
    bool wanted = !rejected();
#if CULLING_ON
    wanted = wanted && fragment.x < SLOT(p, BOUND - 1u).x;
#endif
    CRITICAL_BEGIN(p, wanted)
    insert_sorted(p, fragment);
    CRITICAL_END(p)
}

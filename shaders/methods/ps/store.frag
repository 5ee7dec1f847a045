// KB-PS, store: sorted insertion into K slots, one fragment of a pixel at a time.
// Invariant: outside the critical section the slots are in order, and the last of them only gets nearer: a value of
// it that is out of date lets a fragment through, and never refuses one that belongs.
// Source: Salvi 2013; kplus_2015 §2; the culling is that of §5.1.1.
#include "scene/fragment.glsl"
#include "common/lock.glsl"
#include "methods/ps/slots.glsl"
#include "common/insert_sorted.glsl"

void main() {
    uint p = pixel_index();
    uvec2 fragment = incoming();
    bool wanted = !rejected();
#if CULLING_ON
    wanted = wanted && fragment.x < SLOT(p, uint(K) - 1u).x;
#endif
    CRITICAL_BEGIN(p, wanted)
    insert_sorted(p, fragment);
    CRITICAL_END(p)
}

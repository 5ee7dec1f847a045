// Store of multi-layer alpha blending: inserts the fragment into K sorted layers; if that makes K + 1 layers, the two
// furthest are merged.
// Invariant: outside the critical section the layers are sorted, and together they are as opaque as all fragments so
// far.
// Source: Salvi and Vaidyanathan 2014, §3.
#include "scene/fragment.glsl"
#include "common/lock.glsl"
#include "methods/ps/slots.glsl"
#include "common/insert_sorted.glsl"
#include "methods/mlab/merge.glsl"

void insert(uint p, FRAGMENT fragment) {
    FRAGMENT furthest = insert_sorted(p, fragment);
    if (furthest.x == EMPTY) return;
    uint last = BOUND - 1u;
    write_slot(p, last, merged(read_slot(p, last), furthest));
}

void main() {
    uint p = pixel_index();
    FRAGMENT fragment = incoming();
    CRITICAL_BEGIN(p, !rejected())
    insert(p, fragment);
    CRITICAL_END(p)
}

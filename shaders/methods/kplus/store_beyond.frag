// Store of the multi-pass k+-buffer: keeps the K nearest fragments behind those that earlier iterations have
// composited.
// Invariant: last[p] is the furthest composited fragment. Fragments that equal it in depth and colour cannot be
// distinguished; the first repeats[p] of them to arrive count as already composited.
// Source: kplus_2015 §4.3.
// Buffers: reads last, repeats; updates counter.
#include "scene/fragment.glsl"
#include "common/lock.glsl"
#define COUNTED_OUTSIDE 1
#include "methods/kplus/structure.glsl"

bool beyond(uint p, uvec2 fragment) {
    if (fragment == last[p]) return (atomicAdd(counter[p], 1u) & COUNTED) >= repeats[p];
    return worse(fragment, last[p]);
}

void main() {
    uint p = pixel_index();
    uvec2 fragment = incoming();
    bool wanted = !rejected() && !IS_HELPER;
    if (wanted) wanted = beyond(p, fragment) && !refused(p, fragment);
    CRITICAL_BEGIN(p, wanted)
    insert(p, fragment);
    CRITICAL_END(p)
}

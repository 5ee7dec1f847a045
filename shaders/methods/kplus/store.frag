// Store of the k+-buffer: keeps the K best fragments of each pixel, unsorted; the resolve sorts them.
// Invariant: no fragment that was dropped is better than one that is kept.
// Source: kplus_2015 §3.1-3.2, Alg. 1 and 2; with EXACT_RANGES §4.1, Alg. 3.
#include "scene/fragment.glsl"
#include "common/lock.glsl"
#define COUNTED_OUTSIDE 0
#include "methods/kplus/structure.glsl"

void main() {
    uint p = pixel_index();
    FIND_CELLS(p)
    FRAGMENT fragment = incoming();
    bool wanted = !rejected();
#if CULLING_ON
    wanted = wanted && !refused(p, fragment);
#endif
    CRITICAL_BEGIN(p, wanted)
    insert(p, fragment);
    CRITICAL_END(p)
}

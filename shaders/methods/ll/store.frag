// KB-LL, store: links the fragment into its pixel's list, in order of depth, if fewer than K are nearer.
// Nodes: p is the head of pixel p, pixels + p its tail, 2 * pixels + c the cell c.
// Invariant: links lead from the head through rising depths to the tail. A node is whole before it is linked, and
// never unlinked, so a failed swap starts again from the same predecessor; after RETRIES of them the fragment is
// lost, and counted. Every fragment takes a cell, those beyond the K nearest as well.
// Source: Yu et al. 2012; kplus_2015 §2, §5.3.
#include "scene/fragment.glsl"
#include "common/helper.glsl"
#include "methods/list/alloc.glsl"

void main() {
    if (rejected()) discard;
    uint p = pixel_index(), cell;
    if (!allocate(p, cell)) return;
    uvec2 fragment = incoming();
    uint node = 2u * pixels + cell, at = p, nearer = 0u, failed = 0u;
    cells[node] = fragment;
    bool linked = IS_HELPER;
    while (!linked && nearer < uint(K) && failed < uint(RETRIES)) {
        uint following = next[at];
        if (cells[following].x <= fragment.x) {
            at = following;
            ++nearer;
        } else {
            next[node] = following;
            memoryBarrierBuffer();
            linked = atomicCompSwap(next[at], following, node) == following;
            if (!linked) ++failed;
        }
    }
    if (failed == uint(RETRIES)) atomicAdd(lost_fragments, 1u);
}

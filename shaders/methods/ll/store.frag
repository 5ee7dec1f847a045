// Store of KB-LL: links the fragment into the sorted list of its pixel if fewer than K fragments are nearer. Node p is
// the head of pixel p, node pixels + p its tail, and node 2 * pixels + c is cell c.
// Invariant: links lead from the head through increasing depths to the tail. A node is complete before it is linked and
// is never unlinked, so a failed swap retries at the same predecessor. After RETRIES failed swaps the fragment is
// counted as lost. Every fragment takes a cell, including those that are not among the K nearest.
// Memory: a cell is read through a link that was loaded without a barrier behind it. OpenGL's coherent loads give what
// was published before the link was; Vulkan's model calls it a data race.
// Source: Yu et al. 2012; kplus_2015 §2, §5.3.
// Buffers: updates next, cells.
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
    while (!linked && nearer < BOUND && failed < uint(RETRIES)) {
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

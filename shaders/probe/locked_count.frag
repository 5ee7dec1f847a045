// Self-test of mutual exclusion: each fragment increments a word without atomics, so that any overlap of two critical
// sections loses an increment.
// Buffers: updates counter.
#include "scene/fragment.glsl"
#include "common/lock.glsl"

void main() {
    uint p = pixel_index();
    CRITICAL_BEGIN(p, true)
    counter[p] = counter[p] + 1u;
    CRITICAL_END(p)
}

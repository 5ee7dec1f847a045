// Self-test of mutual exclusion: a plain increment per fragment; any overlap of two fragments loses one.
#include "scene/fragment.glsl"
#include "common/lock.glsl"

void main() {
    uint p = pixel_index();
    CRITICAL_BEGIN(p, true)
    counter[p] = counter[p] + 1u;
    CRITICAL_END(p)
}

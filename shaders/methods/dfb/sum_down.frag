// Downward half of the dynamic fragment buffer's scan: each step replaces the sums of one level by the sums of
// everything before them.
// Invariant: after the last step, address[p] is the number of fragments of all pixels before p.
// Source: Maule et al. 2014, as in kplus_2015 §2 [31]; the scan is that of Blelloch 1990 with FAN children.
// Buffers: reads counter; updates sums; writes address.
#include "common/pixel.glsl"
#include "methods/dfb/levels.glsl"

uniform uint iteration;

void main() {
    uint element = pixel_index(), level = uint(LEVELS) - iteration;
    if (element >= level_size(level)) return;
    uint before = level < uint(LEVELS) ? sums[level_start(level) + element] : 0u;
    uint end = min((element + 1u) * uint(FAN), level_size(level - 1u));
    for (uint child = element * uint(FAN); child < end; ++child) {
        if (level > 1u) {
            uint at = level_start(level - 1u) + child;
            uint total = sums[at];
            sums[at] = before;
            before += total;
        } else {
            address[child] = before;
            before += counter[child];
        }
    }
}

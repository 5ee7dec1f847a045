// Upward half of the dynamic fragment buffer's scan: each step computes one level of sums from the level below.
// Invariant: after step i, each element of level i + 1 is the number of fragments of FAN^(i+1) consecutive pixels.
// Source: Maule et al. 2014, as in kplus_2015 §2 [31]; the scan is that of Blelloch 1990 with FAN children.
// Buffers: reads counter; updates sums.
#include "common/pixel.glsl"
#include "methods/dfb/levels.glsl"

uniform uint iteration;

void main() {
    uint element = pixel_index();
    if (element >= level_size(iteration + 1u)) return;
    uint below = iteration > 0u ? level_start(iteration) : 0u;
    uint end = min((element + 1u) * uint(FAN), level_size(iteration));
    uint total = 0u;
    for (uint child = element * uint(FAN); child < end; ++child)
        total += iteration > 0u ? sums[below + child] : counter[child];
    sums[level_start(iteration + 1u) + element] = total;
}

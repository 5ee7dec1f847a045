// Dynamic fragment buffer, scan upwards: each step makes one level of sums from the one below.
// Invariant: after step i level i + 1 holds the fragments of FAN^(i+1) pixels in a row.
// Source: Maule et al. 2014, as in kplus_2015 §2 [31]; the scan is that of Blelloch 1990 with FAN children.
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

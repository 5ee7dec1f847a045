// Tells of pixels for which the guessed number of layers is too small: one that has more fragments than cells leaves in
// `deepest` how many it needs. To ask each pixel once costs less than to ask each fragment.
// Buffers: updates deepest.
#include "methods/adaptive/region.glsl"

void ask_for_room(uint count) {
    if (count > capacity / PLACES) atomicMax(deepest[0], count);
}

// Classify: assigns each pixel of the region to a class by the number of fragments that the store has counted.
// Buffers: reads counter.
#include "methods/adaptive/classify.glsl"
#include "methods/adaptive/room.glsl"

void main() {
    uint count = counter[place()];
    classify(count);
    ask_for_room(count);
}

// Classify: assigns each pixel of the region to a class by the number of fragments that the store has counted.
// Buffers: reads counter.
#include "methods/adaptive/classify.glsl"
#include "methods/adaptive/region.glsl"

void main() {
    classify(counter[place()]);
}

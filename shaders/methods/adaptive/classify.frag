// Classify: the pixels of the rectangle by what has been stored.
#include "methods/adaptive/classify.glsl"
#include "methods/adaptive/region.glsl"

void main() {
    classify(counter[place()]);
}

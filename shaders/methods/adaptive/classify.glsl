// The class of a pixel's number of fragments, as depth: class i holds at most 2^(i+1) of them, the first four are one, and
// the last has no bound. A class with pixels has its draw.
#include "common/pixel_class.glsl"

void classify(uint count) {
    int index = count == 0u ? NO_CLASS : count <= 16u ? 3 : count <= 64u ? findMSB(count - 1u) : 6;
    gl_FragDepth = CLASS_DEPTH(index);
    if (count > 0u && draws[5 * index] == 0u) {
        draws[5 * index] = 3u;
        draws[5 * index + 1] = 1u;
    }
}

// The class of a pixel's number of fragments, as depth: class i holds at most 2^(i+1) of them, those up to UNCLASSED are
// one, and those beyond HALVES. A class with pixels has its draw.
#include "common/pixel_class.glsl"

void classify(uint count) {
    int index = findMSB(clamp(count, uint(UNCLASSED), uint(HALVES) + 1u) - 1u);
    gl_FragDepth = CLASS_DEPTH(count == 0u ? NO_CLASS : index);
    int command = COMMAND_WORDS * index;
    if (count > 0u && draws[command] == 0u) {
        draws[command] = 3u;  // vertices
        draws[command + 1] = 1u;  // instances
    }
}

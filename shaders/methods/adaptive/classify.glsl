// Assigns a pixel to a class by its number of fragments and writes the class as the depth of the pixel. Class i has at
// most 2^(i+1) fragments; all pixels with up to UNCLASSED fragments share one class, and so do those with more than
// HALVES. The first pixel of a class writes the indirect draw command of that class, so that empty classes draw
// nothing.
// Buffers: updates draws.
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

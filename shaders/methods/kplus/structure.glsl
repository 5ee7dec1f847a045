// The bounded set of the k+-buffer: K slots per pixel, slot 0 holds the furthest fragment kept.
// STRUCTURE_HEAP chooses the max-heap, else the max-array (kplus_2015 §3.2).
#define NODE(p, slot) nodes[(slot) * pixels + (p)]  // depth bits, RGBA8

#if STRUCTURE_HEAP
#include "methods/kplus/heap.glsl"
#else
#include "methods/kplus/array.glsl"
#endif

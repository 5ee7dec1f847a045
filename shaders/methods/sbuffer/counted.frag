// Turns the fragments that blending has counted for each pixel into whole numbers.
// Source: sbuffer_2012 §3.1.
// Buffers: writes counter.
#include "common/pixel.glsl"

void main() {
    counter[pixel_index()] = uint(texelFetch(counted, ivec2(gl_FragCoord.xy), 0).x + 0.5);
}

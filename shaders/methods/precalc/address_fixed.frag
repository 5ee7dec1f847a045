// PreCalc_Fixed, memory referencing: every pixel has room for N fragments, so its range needs no sum.
// Source: sbuffer_2012 §4.
#include "common/pixel.glsl"

void main() {
    uint p = pixel_index();
    address[p] = p * uint(N);
}

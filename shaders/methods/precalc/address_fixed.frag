// Memory referencing of PreCalc_Fixed: every pixel has room for N fragments, so its address needs no prefix sum.
// Source: sbuffer_2012 §4.
// Buffers: writes address.
#include "common/pixel.glsl"

void main() {
    uint p = pixel_index();
    address[p] = p * uint(N);
}

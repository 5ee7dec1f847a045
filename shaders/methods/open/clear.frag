// Clear of open addressing: empties the table, sets every pixel's oldest age to 0, and draws new offsets of the probe
// sequence.
// Source: gpupro5_ch1 §1.3.1, §1.5.1.
// Buffers: writes those of the pass.
#include "common/pixel.glsl"
#include "common/hash.glsl"

void main() {
    CLEAR(pixel_index())
}

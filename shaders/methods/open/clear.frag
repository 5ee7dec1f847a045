// Clear of open addressing: an empty table, no pixel with an age, the offsets of the probe sequence drawn anew.
// Source: gpupro5_ch1 §1.3.1, §1.5.1.
#include "common/pixel.glsl"
#include "common/hash.glsl"

void main() {
    CLEAR(pixel_index())
}

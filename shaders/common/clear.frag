// Clear: gives the method's storage its initial values; a full-screen pass as in the papers (kplus_2015 §3.1).
// Invariant: every element is written by exactly one pixel.
#include "common/pixel.glsl"

void main() {
    CLEAR(pixel_index())
}

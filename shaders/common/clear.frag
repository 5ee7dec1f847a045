// Clear: gives the method's storage its initial values in a full-screen pass, as the papers do (kplus_2015 §3.1). The
// prelude defines CLEAR for the buffers that this pass writes.
// Invariant: every element is written by exactly one pixel.
// Buffers: writes those of the pass.
#include "common/pixel.glsl"

void main() {
    CLEAR(pixel_index())
}

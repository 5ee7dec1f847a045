// Self-test of barriers: shows the counts of an earlier pass by an opaque draw over the whole viewport.
// Buffers: reads counter.
#include "common/pixel.glsl"

void main() {
    out_image = vec4(float(counter[pixel_index()]));
}

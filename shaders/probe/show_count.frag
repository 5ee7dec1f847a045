// Self-test of barriers: shows what an earlier pass counted, in an opaque draw over the whole viewport.
#include "common/pixel.glsl"

void main() {
    out_image = vec4(float(counter[pixel_index()]));
}

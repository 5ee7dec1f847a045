// Adaptive transparency, between the geometry passes: the image gets the opacity of all fragments, to which shading
// adds colours.
#include "common/pixel.glsl"
#include "methods/visibility/nodes.glsl"

void main() {
    out_image = vec4(0.0, 0.0, 0.0, 1.0 - visibility(pixel_index(), EMPTY));
}

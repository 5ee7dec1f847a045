// Pass between the two geometry passes of adaptive transparency: writes the opacity of all fragments into the image, to
// which shading then adds the colours.
#include "common/pixel.glsl"
#include "methods/visibility/nodes.glsl"

void main() {
    out_image = vec4(0.0, 0.0, 0.0, 1.0 - visibility(pixel_index(), EMPTY));
}

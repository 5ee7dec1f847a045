// Dual depth peeling, end: the front layers over the back layers.
#include "common/colour.glsl"

void main() {
    ivec2 xy = ivec2(gl_FragCoord.xy);
    out_image = under(texelFetch(front, xy, 0), texelFetch(back, xy, 0));
}

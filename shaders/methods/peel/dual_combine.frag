// Last pass of dual depth peeling: composites the front layers over the back layers.
#include "common/transmittance.glsl"

void main() {
    ivec2 xy = ivec2(gl_FragCoord.xy);
    out_image = with_opacity(behind_of(texelFetch(front, xy, 0), texelFetch(back, xy, 0)));
}

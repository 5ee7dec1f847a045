// Depth bounds: MAX blending of (-z, z) leaves the nearest and the furthest depth of each pixel.
// Source: Bavoil and Myers 2008.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    out_bounds = vec4(-gl_FragCoord.z, gl_FragCoord.z, 0.0, 0.0);
}

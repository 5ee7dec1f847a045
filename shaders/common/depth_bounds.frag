// Depth bounds: MAX blending of (-z, z) leaves (-nearest depth, furthest depth) in each pixel of the target `bounds`.
// Source: Bavoil and Myers 2008.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
    out_bounds = vec4(-gl_FragCoord.z, gl_FragCoord.z, 0.0, 0.0);
}

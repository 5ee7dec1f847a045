// Store by stencil routing: the stencil test passes only for the sample whose turn it is, so the fragment is written
// there. With MULTI_PASS only primitives from resume[p] on, which earlier passes have not captured, take part.
// Source: Myers and Bavoil 2007; Bavoil and Myers 2008.
// Buffers: reads resume.
#include "scene/fragment.glsl"

void main() {
    if (rejected()) discard;
#if MULTI_PASS
    if (quad < resume[pixel_index()]) discard;
    out_arrivals = uvec4(quad);
#endif
    FRAGMENT fragment = incoming();
    out_depths = uvec4(fragment.x);
    out_colours = uvec4(fragment.y);
}

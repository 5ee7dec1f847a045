// Stencil routing, store: the stencil test sends the fragment to the sample whose turn it is.
// With `resume` only what was submitted after the fragments of the passes before takes part.
// Source: Myers and Bavoil 2007; Bavoil and Myers 2008.
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

// Dual depth peeling: peels the nearest and the furthest fragment that are left, and moves the bounds inwards.
// Invariant: out_bounds (MAX of (-z, z)) encloses the fragments that are left; it is below -1 if none is left, because
// a fragment may be at depth 1. out_front only increases, so that MAX keeps the peeled value. If the nearest and the
// furthest are the same fragment, it is peeled as the nearest.
// Source: Bavoil and Myers 2008, as in kplus_2015 §2.
#include "scene/fragment.glsl"
#include "common/colour.glsl"
#include "methods/peel/front.glsl"

void main() {
    if (rejected()) discard;
    ivec2 xy = ivec2(gl_FragCoord.xy);
    vec2 peeling = texelFetch(bounds, xy, 0).xy;
    float z = gl_FragCoord.z, nearest = -peeling.x, furthest = peeling.y;
    out_bounds = vec4(-2.0);
    out_front = texelFetch(front, xy, 0);
    out_behind = vec4(0.0);
    if (z > nearest && z < furthest) out_bounds.xy = vec2(-z, z);
    else if (z == nearest) out_front = in_front(behind_of(in_front(out_front), premultiplied(incoming().y)));
    else if (z == furthest) out_behind = premultiplied(incoming().y);
}

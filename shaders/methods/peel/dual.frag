// Dual depth peeling: peels the nearest and the furthest fragment that are left, and moves the bounds inwards.
// Invariant: out_bounds (MAX of (-z, z)) encloses the fragments that are left; it is below -1 if none is left, because
// a fragment may be at depth 1. If the nearest and the furthest are the same fragment, it is peeled as the nearest.
// Source: Bavoil and Myers 2008, as in kplus_2015 §2; the front layers are composited by a pass of their own, so that
// fragments peeled before are discarded.
#include "scene/fragment.glsl"
#include "common/colour.glsl"

void main() {
    if (rejected()) discard;
    vec2 peeling = texelFetch(bounds, ivec2(gl_FragCoord.xy), 0).xy;
    float z = gl_FragCoord.z, nearest = -peeling.x, furthest = peeling.y;
    if (z < nearest || z > furthest) discard;
    out_bounds = vec4(-2.0);
    out_ahead = vec4(0.0);
    out_behind = vec4(0.0);
    if (z > nearest && z < furthest) out_bounds.xy = vec2(-z, z);
    else if (z == nearest) out_ahead = premultiplied(incoming().y);
    else out_behind = premultiplied(incoming().y);
}

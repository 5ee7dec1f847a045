// Merges two layers into one and encodes the result as a payload with straight alpha, so that the payload of a layer
// that was never merged keeps its bits.
#include "common/colour.glsl"

PAYLOAD payload_of_colour(vec4 colour) {
    vec4 straight_colour = vec4(colour.a > 0.0 ? colour.rgb / colour.a : vec3(0.0), colour.a);
#if PAYLOAD_RGBA16F
    vec4 stored = 255.0 * straight_colour;
    return PAYLOAD(packHalf2x16(stored.rg), packHalf2x16(stored.ba));
#else
    return packUnorm4x8(straight_colour);
#endif
}

// The merged layer has the depth of the nearer one.
FRAGMENT merged(FRAGMENT nearer, FRAGMENT further) {
    return fragment_of(nearer.x, payload_of_colour(under(colour_of(nearer), colour_of(further))));
}

// Resolves a pixel with at most NETWORK fragments: loads them into registers, sorts them by a sorting network and
// composites them from there.
// Source: Knowles, Leach and Zambetta 2014 (kplus_2015 [34]).
#include "methods/adaptive/registers.glsl"

vec4 resolve_pixel() {
    vec4 colour = NOTHING;
    uint at = first_cell;
    LOAD_BLOCK
    SORT_BLOCK
    EACH(COMPOSITE)
    return colour;
}

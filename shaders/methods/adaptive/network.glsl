// Resolve of at most NETWORK fragments: read into registers, sorted by a network, composited from there.
// Source: Knowles, Leach and Zambetta 2014 (kplus_2015 [34]).
#include "common/network.glsl"

#define LOAD(i) \
    block[i] = NO_FRAGMENT; \
    if (at < end_cell) block[i] = nodes[at]; \
    at += cell_step;
#define COMPOSITE(i) colour = behind_of(colour, colour_of(block[i]));

vec4 resolve_pixel() {
    vec4 colour = NOTHING;
    uint at = first_cell;
    EACH(LOAD)
    SORT_BLOCK
    EACH(COMPOSITE)
    return colour;
}

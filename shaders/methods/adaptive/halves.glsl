// Resolve of at most 64 fragments in registers: each half that there is is sorted; the nearer fragments of both come
// first, and the others only where more than MAX_ERROR shows through.
// Invariant: two sorted halves, one of them backwards, are a bitonic sequence, and so are its nearer and further half.
// Error: what is left out changes no channel by more than the transmittance before it, at most MAX_ERROR.
// Source: registers, Knowles, Leach and Zambetta 2014 (kplus_2015 [34]); bitonic merge, Batcher 1968.
#include "methods/adaptive/registers.glsl"

#define PART(i) COMPARE(i, 63 - (i))

vec4 resolve_pixel() {
    vec4 colour = NOTHING;
    uint at = first_cell;
    EACH32(LOAD, 0)
    SORT32(0)
    bool more = at < end_cell;
    if (more) {
        EACH32(LOAD, 32)
        SORT32(32)
        EACH32(PART, 0)
        CLEAN32(0)
    }
    EACH32(COMPOSITE, 0)
    if (more && colour.a > MAX_ERROR) {
        CLEAN32(32)
        EACH32(COMPOSITE, 32)
    }
    return colour;
}

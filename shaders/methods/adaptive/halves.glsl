// Resolves a pixel with at most 64 fragments in registers: sorts each half of 32 that exists, and composites the nearer
// 32 fragments of both first; the others follow only if more than MAX_ERROR of the light still shows through.
// Invariant: two sorted halves, one of them reversed, form a bitonic sequence; so do its nearer and its further half.
// Error: omitted fragments change no channel by more than the transmittance before them, which is at most MAX_ERROR.
// Source: use of registers, Knowles, Leach and Zambetta 2014 (kplus_2015 [34]); bitonic merge, Batcher 1968.
#include "methods/adaptive/registers.glsl"

vec4 resolve_pixel() {
    vec4 colour = NOTHING;
    uint at = first_cell;
    LOAD_BLOCK
    FIRST32(SORT32)
    bool more = at < end_cell;
    if (more) {
        LOAD_SECOND
        SECOND32(SORT32)
        OPPOSITE(COMPARE)
        FIRST32(CLEAN32)
    }
    EACH32(COMPOSITE)
    if (more && colour.a > MAX_ERROR) {
        SECOND32(CLEAN32)
        NEXT32(COMPOSITE)
    }
    return colour;
}

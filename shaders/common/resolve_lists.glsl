// Computes the colour of a pixel that has one list of fragments, or LISTS of them. Each list is resolved by itself, and
// the results are composited, nearest list first.
vec4 resolve_lists(uint p) {
#if LISTS > 1
    vec4 colour = vec4(0.0);
    for (uint list = 0u; list < uint(LISTS); ++list) colour = under(colour, resolve_pixel(list * pixels + p));
    return colour;
#else
    return resolve_pixel(p);
#endif
}

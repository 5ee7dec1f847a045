// Resolve of fragments that already come nearest first: composites them as they are read.
vec4 resolve_pixel(uint p) {
    vec4 colour = vec4(0.0);
    FRAGMENT fragment;
    for (fetch_begin(p); fetch_next(fragment);) colour = under(colour, colour_of(fragment));
    return colour;
}

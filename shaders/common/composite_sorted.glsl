// Composites a pixel's fragments as its fetch reads them, nearest first.
vec4 composite_sorted(uint p) {
    vec4 colour = vec4(0.0);
    FRAGMENT fragment;
    for (fetch_begin(p); fetch_next(fragment);) colour = under(colour, colour_of(fragment));
    return colour;
}

// Reads the first K samples of a stencil-routed pixel, in order of arrival.
ivec2 fetch_xy;
int fetch_at;

void fetch_begin(uint p) {
    fetch_xy = ivec2(p % width, p / width);
    fetch_at = 0;
}

bool fetch_next(out FRAGMENT fragment) {
    if (fetch_at >= K) return false;
    uint depth = texelFetch(depths, fetch_xy, fetch_at).x;
    if (depth == EMPTY) return false;
    fragment = FRAGMENT(depth, texelFetch(colours, fetch_xy, fetch_at).x);
    ++fetch_at;
    return true;
}

// Reads the sorted depths and colours of a pixel.
uint fetch_at, fetch_end;

void fetch_begin(uint p) {
    fetch_at = p;
    fetch_end = p + uint(K) * pixels;
}

bool fetch_next(out uvec2 fragment) {
    if (fetch_at >= fetch_end || depths[fetch_at] == EMPTY) return false;
    fragment = uvec2(depths[fetch_at], colours[fetch_at]);
    fetch_at += pixels;
    return true;
}

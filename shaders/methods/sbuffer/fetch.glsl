// Reads a pixel's contiguous range, which ends at its address.
uint fetch_at, fetch_end;

void fetch_begin(uint p) {
    fetch_end = address[p];
    fetch_at = fetch_end - counter[p];
}

bool fetch_next(out uvec2 fragment) {
    if (fetch_at >= fetch_end) return false;
    fragment = nodes[fetch_at++];
    return true;
}

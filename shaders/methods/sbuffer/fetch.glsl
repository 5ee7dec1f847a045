// Reads a pixel's contiguous range, which ends at its address.
#define FETCH_COUNT(p) counter[p]

uint fetch_at, fetch_end;

void fetch_begin(uint p) {
    fetch_end = address[p];
    fetch_at = fetch_end - FETCH_COUNT(p);
}

bool fetch_next(out FRAGMENT fragment) {
    if (fetch_at >= fetch_end) return false;
    fragment = nodes[fetch_at++];
    return true;
}

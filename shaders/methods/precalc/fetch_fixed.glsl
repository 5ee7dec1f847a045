// Reads a pixel's range of N slots as far as its counter.
#define FETCH_COUNT(p) min(counter[p], uint(N))

uint fetch_at, fetch_end;

void fetch_begin(uint p) {
    fetch_at = address[p];
    fetch_end = fetch_at + FETCH_COUNT(p);
}

bool fetch_next(out FRAGMENT fragment) {
    if (fetch_at >= fetch_end) return false;
    fragment = nodes[fetch_at++];
    return true;
}

// Reads the fragments of a pixel from its range of N slots; the counter of the pixel ends them.
// Buffers: reads counter, address, nodes.
#define FETCH_COUNT(p) min(counter[p], uint(N))

uint fetch_at, fetch_end;

void fetch_begin(uint p) {
    fetch_at = address[p];
    fetch_end = fetch_at + FETCH_COUNT(p);
}

bool fetch_next(out FRAGMENT fragment) {
    if (fetch_at >= fetch_end) return false;
    fragment = nodes_at(fetch_at++);
    return true;
}

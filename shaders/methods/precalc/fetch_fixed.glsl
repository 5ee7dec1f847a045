// Reads the fragments of a pixel from its range of N slots; the counter of the pixel ends them.
// Buffers: reads counter, address, nodes.
#define FETCH_COUNT(p) min(counter[p], uint(N))

uint fetch_at, fetch_end;

void fetch_begin(uint p) {
    fetch_at = address[p];
    fetch_end = fetch_at + FETCH_COUNT(p);
}

bool fetch_next(out FRAGMENT fragment) {
    bool found = fetch_at < fetch_end;
    if (found) fragment = nodes_at(fetch_at);
    ++fetch_at;
    return found;
}

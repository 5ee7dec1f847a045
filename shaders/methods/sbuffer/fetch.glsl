// Reads the contiguous range of a pixel; after the store its address is the end of the range.
// Buffers: reads counter, address, nodes.
#define FETCH_COUNT(p) counter[p]

uint fetch_at, fetch_end;

void fetch_begin(uint p) {
    fetch_end = address[p];
    fetch_at = fetch_end - FETCH_COUNT(p);
}

bool fetch_next(out FRAGMENT fragment) {
    bool found = fetch_at < fetch_end;
    if (found) fragment = nodes_at(fetch_at);
    ++fetch_at;
    return found;
}

// Reads the fragments of a pixel from its array, in order of arrival. Slot s of pixel p is at s * pixels + p, so that
// neighbouring pixels read neighbouring words.
// Buffers: reads counter, nodes.
#define FETCH_COUNT(p) min(counter[p], uint(SLOTS))

uint fetch_at, fetch_end;

void fetch_begin(uint p) {
    fetch_at = p;
    fetch_end = p + FETCH_COUNT(p) * pixels;
}

bool fetch_next(out FRAGMENT fragment) {
    bool found = fetch_at < fetch_end;
    if (found) fragment = nodes_at(fetch_at);
    fetch_at += pixels;
    return found;
}

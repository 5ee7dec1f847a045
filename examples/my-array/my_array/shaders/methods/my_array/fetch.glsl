// Reads the fragments of a pixel from its array: slot s of pixel p is at s * pixels + p.
// It repeats methods/array/fetch.glsl of mfr-bench and does not include it: this file and store.frag share one layout,
// which is yours to change, and which no later version of mfr-bench may change in one of the two alone.
// Buffers: reads counter, nodes.
#define FETCH_COUNT(p) min(counter[p], uint(N))

uint fetch_at, fetch_end;

void fetch_begin(uint p) {
    fetch_at = p;
    fetch_end = p + FETCH_COUNT(p) * pixels;
}

bool fetch_next(out FRAGMENT fragment) {
    if (fetch_at >= fetch_end) return false;
    fragment = nodes_at(fetch_at);
    fetch_at += pixels;
    return true;
}

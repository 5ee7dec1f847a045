// Reads a pixel's K slots, which hold its fragments nearest first, as far as the first empty one.
// The includer gives slot_fragment(at); slots of neighbouring pixels lie side by side.
uint fetch_at, fetch_end;

void fetch_begin(uint p) {
    fetch_at = p;
    fetch_end = p + uint(K) * pixels;
}

bool fetch_next(out FRAGMENT fragment) {
    if (fetch_at >= fetch_end) return false;
    fragment = slot_fragment(fetch_at);
    fetch_at += pixels;
    return fragment.x != EMPTY;
}

// Reads the K sorted slots of a pixel, nearest first, up to the first empty slot. The including file defines
// slot_fragment(at). Slot s of pixel p is at s * pixels + p, so that neighbouring pixels read neighbouring words.
uint fetch_at, fetch_end;

void fetch_begin(uint p) {
    fetch_at = p;
    fetch_end = p + BOUND * pixels;
}

bool fetch_next(out FRAGMENT fragment) {
    if (fetch_at >= fetch_end) return false;
    fragment = slot_fragment(fetch_at);
    fetch_at += pixels;
    return fragment.x != EMPTY;
}

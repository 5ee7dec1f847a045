// KB-LL, clear: each list is its two sentinels, nearer and further than any fragment.
// WHOLE: every pixel is cleared, and the first one clears the counter.
#include "common/pixel.glsl"

void main() {
    uint head = pixel_index(), tail = pixels + head;
    cells[head] = uvec2(0u);
    cells[tail] = uvec2(EMPTY, 0u);
    next[head] = tail;
    next[tail] = EMPTY;
#if WHOLE
    if (head == 0u) cell_counter[0] = 0u;
#endif
}

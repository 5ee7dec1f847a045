// Clear of KB-LL: makes each list consist of its two sentinels, one nearer and one further than any fragment. With
// WHOLE every pixel of the viewport is cleared, and the first pixel also clears the counter of cells.
// Buffers: writes cells, next, cell_counter.
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

// Cells of a linked list come from one shared counter; none is ever given back (gpupro5_ch1 §1.2).
// next[p] for p < pixels is the head of pixel p; cell c has its link at next[pixels + c].
// Invariant: cells allocated past the capacity are counted but not used; the frame is then redone.
bool allocate(out uint cell) {
    cell = atomicAdd(cell_counter[0], 1u);
    return cell < capacity;
}

// Probe sequence of a pixel: gives the cell where its fragment of a certain age may be. All pixels share the same
// offsets.
// Invariant: capacity >= pixels, so that a cell and an age identify the pixel. No two offsets are equal, since their
// remainders by 256 are not: a fragment that was displaced never returns to a cell.
// Source: gpupro5_ch1 §1.3.1.
// Buffers: reads offsets.
uint probe(uint p, uint age) {
    return (p + offsets[age]) % capacity;
}

uint prober(uint at, uint age) {
    return (at + capacity - offsets[age]) % capacity;
}

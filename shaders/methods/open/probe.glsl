// The probe sequence of a pixel: where its fragment of each age may stand; the same offsets for all pixels.
// Invariant: capacity >= pixels, so that cell and age name the pixel.
// Source: gpupro5_ch1 §1.3.1.
uint probe(uint p, uint age) {
    return (p + offsets[age]) % capacity;
}

uint prober(uint at, uint age) {
    return (at + capacity - offsets[age]) % capacity;
}

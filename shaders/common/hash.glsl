// Counter-based integer hash; mfr_bench/hashing.py computes the same bits.
// Source: lowbias32 finalizer, C. Wellons 2018.
uint mix_bits(uint x) {
    x = (x ^ (x >> 16)) * 0x7FEB352Du;
    x = (x ^ (x >> 15)) * 0x846CA68Bu;
    return x ^ (x >> 16);
}

uint hash3(uint a, uint b, uint c) {
    return mix_bits(a ^ mix_bits(b ^ mix_bits(c)));
}

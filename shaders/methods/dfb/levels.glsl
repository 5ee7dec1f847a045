// Levels of the hierarchical sum: level 0 is the pixels, and each element of level l is the sum of FAN elements of
// level l - 1. The buffer `sums` contains levels 1, 2, … one after the other.
uint level_size(uint level) {
    uint size = pixels;
    for (uint i = 0u; i < level; ++i) size = (size + uint(FAN) - 1u) / uint(FAN);
    return size;
}

uint level_start(uint level) {
    uint start = 0u;
    for (uint i = 1u; i < level; ++i) start += level_size(i);
    return start;
}

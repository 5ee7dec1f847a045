// The levels of the hierarchical sum: level 0 are the pixels; an element of level l sums FAN of level l - 1.
// Levels 1, 2, … stand one behind the other in `sums`.
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

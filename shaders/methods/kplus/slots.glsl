// Where the k+-buffer keeps a pixel's fragments: slot 0 the worst of them, slots 1 .. room-1 the others.
// Invariant: slot 0 is empty until all others are taken, and only gets better from then on: a value of it that is
// out of date lets a fragment through, and never refuses one that belongs.
// counter[p]: slots taken in the upper bits, in the lower ones fragments counted.
const uint COUNTED_BITS = 21u;
const uint ONE_TAKEN = 1u << COUNTED_BITS;
const uint COUNTED = ONE_TAKEN - 1u;

#if EXACT_RANGES
#define NODE(p, slot) nodes[address[p] + (slot)]  // depth bits, RGBA8
#define ROOM(p) (counter[p] & COUNTED)
#else
#define NODE(p, slot) nodes[(slot) * pixels + (p)]
#define ROOM(p) uint(K)
#endif

uint taken(uint p) {
    return counter[p] >> COUNTED_BITS;
}

// Layout of the k+-buffer of a pixel: slot 0 contains the worst fragment, slots 1 .. room - 1 the others. The upper
// bits of counter[p] are the number of slots taken, the lower bits the number of fragments counted.
// Invariant: slot 0 stays empty until all other slots are taken, and from then on its fragment only gets better. An
// outdated value of it may let a fragment through, but never refuses one that belongs into the buffer.
// Buffers: defines NODE for nodes, with EXACT_RANGES by way of address; reads counter.
const uint COUNTED_BITS = 21u;
const uint ONE_TAKEN = 1u << COUNTED_BITS;
const uint COUNTED = ONE_TAKEN - 1u;

#if EXACT_RANGES
#define NODE(p, slot) nodes[address[p] + (slot)]  // depth bits, RGBA8
#define ROOM(p) (counter[p] & COUNTED)
#else
#define NODE(p, slot) nodes[(slot) * pixels + (p)]
#define ROOM(p) BOUND
#endif

uint taken(uint p) {
    return counter[p] >> COUNTED_BITS;
}

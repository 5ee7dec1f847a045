// Layout of the k+-buffer of a pixel: slot 0 contains the worst fragment, slots 1 .. room - 1 the others. The upper
// bits of counter[p] are the number of slots taken, the lower bits the number of fragments counted.
// Invariant: slot 0 stays empty until all other slots are taken, and from then on its fragment only gets better. An
// outdated value of it may let a fragment through, but never refuses one that belongs into the buffer.
// Each invocation finds the cells of its pixel first, by FIND_CELLS(p).
// Buffers: defines NODE for nodes, with EXACT_RANGES by way of address; reads counter.
const uint COUNTED_BITS = 21u;
const uint ONE_TAKEN = 1u << COUNTED_BITS;
const uint COUNTED = ONE_TAKEN - 1u;

#if EXACT_RANGES
#define ROOM(p) (counter[p] & COUNTED)
uint first_cell;
#if SUMS_FRAGMENT
#include "methods/sbuffer/sums.glsl"
#define FIND_CELLS(p) first_cell = first_of_range(p, address[p], ROOM(p));
#else
#define FIND_CELLS(p) first_cell = address[p];
#endif
#define STRIDE 1u
#define PLACE(p, slot) (first_cell + (slot))
#else
#define FIND_CELLS(p)
#define STRIDE pixels
#define PLACE(p, slot) ((slot) * pixels + (p))
#define ROOM(p) BOUND
#endif

#define NODE(p, slot) nodes[PLACE(p, slot)]  // depth bits, RGBA8

uint taken(uint p) {
    return counter[p] >> COUNTED_BITS;
}

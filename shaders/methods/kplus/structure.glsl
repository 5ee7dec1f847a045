// Inserts a fragment into the bounded set of a pixel, inside the critical section. The set is a max-array or a
// max-heap. With STRUCTURE_ADAPTIVE it is a heap if K > 16 and the pixel has at least K fragments, otherwise an array
// (kplus_2015 §4.1, Alg. 3, line 23). COUNTED_OUTSIDE tells whether fragments change the counter of the pixel outside
// the critical section as well.
// Buffers: reads nodes; updates counter.
#include "methods/kplus/criterion.glsl"
#include "methods/kplus/slots.glsl"
#include "methods/kplus/array.glsl"
#include "methods/kplus/heap.glsl"

bool is_heap(uint room) {
#if STRUCTURE_ADAPTIVE
    return uint(K) > 16u && room == uint(K);
#else
    return STRUCTURE_HEAP == 1;
#endif
}

// Tests without the lock whether the set refuses the fragment: the set is full and all of its fragments are better
// (kplus_2015 §3.2). Ties are left to `insert`.
bool refused(uint p, FRAGMENT fragment) {
    return surely_worse(fragment, NODE(p, 0u));
}

// Inserts the fragment. Slot 0 is read only where no slot is free: until then it is empty.
void insert(uint p, FRAGMENT fragment) {
    uint room = ROOM(p), slot = taken(p) + 1u;
    if (slot > room && !worse(NODE(p, 0u), fragment)) return;
    bool heap = is_heap(room);
    if (slot < room) {
        if (heap) heap_fill(p, slot, fragment);
        else array_fill(p, slot, fragment);
    } else {
        if (heap) heap_replace(p, room, fragment);
        else array_replace(p, room, fragment);
    }
#if COUNTED_OUTSIDE
    if (slot <= room) atomicAdd(counter[p], ONE_TAKEN);
#else
    if (slot <= room) counter[p] += ONE_TAKEN;
#endif
}

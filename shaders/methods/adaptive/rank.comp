// Orders primitives that have one depth everywhere: each counts the primitives behind it, which is the place of its
// indirect draw. The draws then go from the furthest to the nearest.
// Invariant: the places are a permutation of 0 … capacity - 1; of equal depths the one submitted first is drawn first.
// There is room for as many commands as a pixel can have fragments; the test for it would count what is lost.
// Buffers: reads nodes; writes order.
layout(local_size_x = ORDERERS) in;

uint place_of(uint primitive) {
    uint depth = nodes[primitive].x, place = 0u;
    for (uint i = 0u; i < capacity; ++i) {
        uint other = nodes[i].x;
        if (other > depth || (other == depth && i < primitive)) ++place;
    }
    return place;
}

void main() {
    uint primitive = gl_GlobalInvocationID.x;
    if (primitive >= capacity) return;
    uint command = uint(COMMAND_WORDS) * place_of(primitive);
    if (command + uint(COMMAND_WORDS) > order_length) {
        atomicAdd(lost_fragments, 1u);
        return;
    }
    order[command] = 4u;  // vertices
    order[command + 1u] = 1u;  // instances
    order[command + 2u] = 0u;  // first vertex
    order[command + 3u] = primitive;  // first instance
}

// Trial of uniform blocks: stores by a dispatch, with a uniform block and another storage block.
// Buffers: writes dispatched.
layout(local_size_x = 1) in;

void main() {
    dispatched[0] = width + 1u;
}

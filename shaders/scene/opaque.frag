// Writes nothing: opaque triangles leave only their depth.
void main() {
}

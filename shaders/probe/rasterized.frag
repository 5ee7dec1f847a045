// Does nothing: an occlusion query counts the fragments that the rasterizer generates from the geometry.
void main() {
}

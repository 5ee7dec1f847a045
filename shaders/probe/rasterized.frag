// Nothing: what the rasterizer makes of the geometry is counted by an occlusion query.
void main() {
}

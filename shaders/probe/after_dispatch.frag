// Trial of uniform blocks: shows what a draw after a dispatch sees in uniform blocks.
// Buffers: none.
void main() {
    out_image = vec4(float(width), float(height), float(pixels), 1.0);
}

// Fill rate: one constant colour for every pixel.
void main() {
    out_image = vec4(0.25);
}

// Measures the fill rate: writes one constant colour to every pixel.
void main() {
    out_image = vec4(0.25);
}

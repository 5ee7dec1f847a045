// The image holds the transmittance in place of the opacity: blending puts 1 minus it there, and leaves the colour.
void main() {
    out_image = vec4(0.0, 0.0, 0.0, 1.0);
}

// Converts the alpha channel of the image from transmittance to opacity: blending writes 1 minus the transmittance and
// leaves the colour as it is.
void main() {
    out_image = vec4(0.0, 0.0, 0.0, 1.0);
}

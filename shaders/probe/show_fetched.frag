// Trial of framebuffer fetch: shows the digits and the count that the fragments have left in the pixel.
void main() {
    out_image = vec4(out_seen.xy, 0.0, 1.0);
}

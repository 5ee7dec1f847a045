// Trial of framebuffer fetch: appends the number of the quad to those of the quads before, as a digit, and counts it.
flat in uint quad;

void main() {
    out_seen = uvec4(uint(QUADS) * out_seen.x + quad, out_seen.y + 1u, 0u, 0u);
}

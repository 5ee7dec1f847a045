// Gives the pixel of this invocation as an index into per-pixel storage; row 0 is at the bottom.
uint pixel_index() {
    uvec2 xy = uvec2(gl_FragCoord.xy);
    return xy.y * width + xy.x;
}

// The depth behind which no more than MAX_ERROR shows through: the end of the first half of the depths before FURTHEST_CUT
// that is that opaque, or of both. Fragments beyond it are discarded by early z.
void main() {
    vec2 units = texelFetch(opacity, ivec2(gl_FragCoord.xy), 0).rg * 255.0;
    float wanted = -log2(MAX_ERROR) * 16.0 + 0.5;
    gl_FragDepth = units.x >= wanted ? FURTHEST_CUT / 2.0 : units.x + units.y >= wanted ? FURTHEST_CUT : 1.0;
}

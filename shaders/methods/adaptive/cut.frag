// Finds, for each pixel, a depth behind which no more than MAX_ERROR of the light shows through: FURTHEST_CUT / 2 if
// the first half of the depths before FURTHEST_CUT is opaque enough, FURTHEST_CUT if both halves together are,
// otherwise 1. Early z then discards the fragments beyond that depth.
void main() {
    vec2 units = texelFetch(opacity, ivec2(gl_FragCoord.xy), 0).rg * 255.0;
    float wanted = -log2(MAX_ERROR) * 16.0 + 0.5;
    gl_FragDepth = units.x >= wanted ? FURTHEST_CUT / 2.0 : units.x + units.y >= wanted ? FURTHEST_CUT : 1.0;
}

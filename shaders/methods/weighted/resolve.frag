// Resolve of weighted blended OIT: the image is the weighted mean of the colours, as opaque as all fragments together.
// A sum that overflows a half counts as the largest half.
// Source: McGuire and Bavoil 2013, §4, Eq. 6.
const float GREATEST_HALF = 65504.0;

void main() {
    ivec2 xy = ivec2(gl_FragCoord.xy);
    vec4 sum = texelFetch(accumulation, xy, 0);
#if PRECISION_16F
    sum = min(sum, GREATEST_HALF);
#endif
    float opacity = 1.0 - texelFetch(revealage, xy, 0).x;
    out_image = vec4(sum.a > 0.0 ? sum.rgb / sum.a * opacity : vec3(0.0), opacity);
}

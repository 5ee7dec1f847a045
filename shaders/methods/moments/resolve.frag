// Resolve of moment-based OIT: scales the sum of the shaded colours so that it is as opaque as all fragments together.
// Source: Muenstermann et al. 2018, §3.3.
void main() {
    ivec2 xy = ivec2(gl_FragCoord.xy);
    vec4 sum = texelFetch(shaded, xy, 0);
    float opacity = 1.0 - exp(-texelFetch(absorbance, xy, 0).x);
    out_image = vec4(sum.a > 0.0 ? sum.rgb / sum.a * opacity : vec3(0.0), opacity);
}

// The depth behind which no more than MAX_ERROR shows through: the end of the first quarter that, with those before it,
// is that opaque. Fragments beyond it are discarded by early z.
void main() {
    vec2 units = texelFetch(opacity, ivec2(gl_FragCoord.xy), 0).rg * 255.0;
    float wanted = -log2(MAX_ERROR) * 16.0, sum = 0.0;
    gl_FragDepth = 1.0;
    for (int quarter = 0; quarter < 2; ++quarter) {
        sum += units[quarter];
        if (sum >= wanted + 0.5) {
            gl_FragDepth = float(quarter + 1) / 4.0;
            break;
        }
    }
}

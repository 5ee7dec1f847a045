// Calibrates timers: every pixel does the same arithmetic, in proportion to ROUNDS.
void main() {
    vec4 value = vec4(gl_FragCoord.xy, 1.0, 1.0);
    for (int i = 0; i < ROUNDS; ++i) value = fract(value * 1.37 + value.yzwx);
    out_image = value;
}

// Calibrates timers: every pixel does the same arithmetic, in proportion to chosen_k, the rounds. They are no constant, so
// that work of every size is one program.
void main() {
    vec4 value = vec4(gl_FragCoord.xy, 1.0, 1.0);
    for (uint i = 0u; i < chosen_k; ++i) value = fract(value * 1.37 + value.yzwx);
    out_image = value;
}

// Trial of blending: a colour and an alpha that all formats but those of 8 and 16 bits hold exactly.
void main() {
    out_blended = vec4(vec3(0.25), 0.5);
#if BESIDE
    out_beside = vec4(vec3(0.25), 0.5);
#endif
}

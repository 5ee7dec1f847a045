// Trial of blending: a quarter in every channel, which all formats but those of 8 and 16 bits hold exactly.
void main() {
    out_blended = vec4(0.25);
}

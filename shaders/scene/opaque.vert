// Draws opaque triangles as scene/triangle.vert draws others, so that their depths compare exactly with those of
// fragments.
in vec4 in_corner;  // clip space

invariant gl_Position;

void main() {
    gl_Position = in_corner;
}

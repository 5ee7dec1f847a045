// Draws triangles over the whole viewport that hand on where they are. It stands by itself, without a prelude, as the
// fragment shader does.
out vec2 place;

void main() {
    int corner = gl_VertexID % 3;
    place = vec2(2.0 * float(corner & 1), 2.0 * float(corner >> 1));
    gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0);
}

// Trial of a primitive's number beside an input of the vertex shader, the place from 0 to 1 in the viewport: each
// triangle counts the pixels that see both. It stands by itself, without a prelude.
// Buffers: writes seen, a word for each triangle and one for all other numbers.
layout(std430, binding = 0) buffer Seen { uint seen[]; };
uniform uint triangles;
uniform uint columns;
uniform uint rows;
in vec2 place;
out vec4 out_colour;

void main() {
    vec2 pixel = place * vec2(columns, rows);
    if (distance(pixel, gl_FragCoord.xy) < 0.01) atomicAdd(seen[min(uint(gl_PrimitiveID), triangles)], 1u);
    out_colour = vec4(1.0);
}

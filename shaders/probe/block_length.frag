// Trial of a storage block's length behind loops that lanes leave at different times: each pixel tells what it sees.
// It stands by itself, without a prelude, since other text around it hides the fault.
// Buffers: writes first, second and seen.
layout(std430, binding = 0) buffer First { uint first[]; };
layout(std430, binding = 1) buffer Second { uint second[]; };
layout(std430, binding = 2) buffer Seen { uint seen[]; };
uniform uint columns;
uniform uint pixels;
out vec4 out_colour;

void main() {
    uint p = uint(gl_FragCoord.y) * columns + uint(gl_FragCoord.x);
    for (uint i = p; i < uint(first.length()) && i < 100000u; i += pixels) first[i] = 1u;
    for (uint i = p; i < uint(second.length()) && i < 100000u; i += pixels) second[i] = 2u;
    seen[p] = uint(second.length());
    out_colour = vec4(1.0);
}

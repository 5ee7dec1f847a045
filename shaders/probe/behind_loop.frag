// Trial of elements of a storage block behind a loop that lanes leave at different times. Each pixel adds up elements
// from the place on that its own element names, and then tells its own element and the one that it added last. It stands
// by itself, without a prelude.
// Buffers: reads words; writes seen.
layout(std430, binding = 0) readonly buffer Words { uint words[]; };
layout(std430, binding = 1) buffer Seen { uint seen[]; };
uniform uint columns;
out vec4 out_colour;

void main() {
    uint p = uint(gl_FragCoord.y) * columns + uint(gl_FragCoord.x), at = 0u, sum = 0u, last = 0u;
    while (true) {
        last = words[words[p] + at];
        sum += last;
        if (++at > p % 7u) break;
    }
    seen[3u * p] = sum;
    seen[3u * p + 1u] = words[p];
    seen[3u * p + 2u] = last;
    out_colour = vec4(1.0);
}

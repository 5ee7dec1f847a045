// Trial of a local array whose elements a loop stores behind a comparison of its counter's next value. Each pixel puts
// the pairs of descending numbers in order, and counts those that are where they belong. It stands by itself, without a
// prelude.
// Buffers: reads words; writes seen.
layout(std430, binding = 0) readonly buffer Words { uint words[]; };
layout(std430, binding = 1) buffer Seen { uint seen[]; };
uniform uint columns;
uniform uint count;
out vec4 out_colour;

void main() {
    uint held[128];
    for (uint i = 0u; i < count; ++i) held[i] = words[i];
    for (uint i = 0u; i < count; i += 2u) {
        uint a = held[i], b = held[i + 1u];
        bool more = i + 2u < count;
        held[i] = min(a, b);
        held[i + 1u] = max(a, b);
        if (!more) break;
    }
    uint right = 0u;
    for (uint i = 0u; i < count; ++i) right += uint(held[i] == words[i ^ 1u]);
    seen[uint(gl_FragCoord.y) * columns + uint(gl_FragCoord.x)] = right;
    out_colour = vec4(1.0);
}

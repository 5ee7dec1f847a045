// Trial of a program with more values at once than a processor has registers: each pixel reads its list of nodes into 16
// places, sorts eight of them and composites all. Nodes that are left behind are counted. It stands by itself, without a
// prelude, since other text around it hides the fault. The loop is bounded, for the fault is a number that does not grow.
// Buffers: reads count, ends and nodes; writes left_behind.
uniform uint columns;
uniform uint rows;
layout(std430, binding = 0) readonly buffer Counts { uint count[]; };
layout(std430, binding = 1) readonly buffer Ends { uint ends[]; };
layout(std430, binding = 2) readonly buffer Nodes { uvec2 nodes[]; };
layout(std430, binding = 3) buffer LeftBehind { uint left_behind; };
layout(binding = 0) uniform sampler2D chosen;
layout(rgba32f, binding = 0) writeonly uniform image2D out_image;
layout(local_size_x = 8, local_size_y = 8) in;

uint at, end;
uvec2 block[16];

bool next(out uvec2 node) {
    if (at >= end) return false;
    node = nodes[at++];
    return true;
}

#define LOAD(i) found = found && next(node); block[i] = found ? node : uvec2(4294967295u, 0u);
#define COMPARE(a, b) { \
    uvec2 low = block[a], high = block[b]; \
    bool swapped = high.x < low.x; \
    block[a] = swapped ? high : low; \
    block[b] = swapped ? low : high; }
#define COMPOSITE(i) { \
    vec4 layer = unpackUnorm4x8(block[i].y); \
    colour = vec4(colour.rgb + colour.a * layer.rgb * layer.a, colour.a * (1.0 - layer.a)); }
#define EACH(DO) DO(0) DO(1) DO(2) DO(3) DO(4) DO(5) DO(6) DO(7) \
    DO(8) DO(9) DO(10) DO(11) DO(12) DO(13) DO(14) DO(15)

vec4 composited(uint p) {
    end = ends[p];
    at = end - count[p];
    bool found = true;
    uvec2 node;
    EACH(LOAD)
    COMPARE(0, 1) COMPARE(2, 3) COMPARE(4, 5) COMPARE(6, 7) COMPARE(0, 2) COMPARE(1, 3) COMPARE(4, 6) COMPARE(5, 7)
    COMPARE(1, 2) COMPARE(5, 6) COMPARE(0, 4) COMPARE(1, 5) COMPARE(2, 6) COMPARE(3, 7) COMPARE(2, 4) COMPARE(3, 5)
    COMPARE(1, 2) COMPARE(3, 4) COMPARE(5, 6)
    vec4 colour = vec4(0.0, 0.0, 0.0, 1.0);
    if (found) {
        uint more = 0u;
        while (more < 64u && next(node)) ++more;
        if (more > 0u) atomicAdd(left_behind, more);
    }
    EACH(COMPOSITE)
    return vec4(colour.rgb, 1.0 - colour.a);
}

void main() {
    for (uint number = gl_WorkGroupID.x; number < (columns / 8u) * (rows / 8u); number += gl_NumWorkGroups.x) {
        uvec2 xy = 8u * uvec2(number % (columns / 8u), number / (columns / 8u)) + gl_LocalInvocationID.xy;
        if (xy.x < columns && xy.y < rows && texelFetch(chosen, ivec2(xy), 0).x == 0.0625)
            imageStore(out_image, ivec2(xy), composited(xy.y * columns + xy.x));
    }
}

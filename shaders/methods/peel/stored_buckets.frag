// Counts the layers that bucket peeling takes from a pixel: in each bucket with fragments left the nearest, and the
// furthest if that is a different fragment. This pass runs outside timed frames.
void main() {
    uint held = 0u;
    for (int bucket = 0; bucket < BUCKETS; ++bucket) {
        vec2 edge = texelFetch(edges, ivec3(gl_FragCoord.xy, bucket), 0).xy;
        if (edge.y >= 0.0 && edge.y <= 1.0) held += edge.y > -edge.x ? 2u : 1u;
    }
    if (held > 0u) atomicAdd(stored_fragments, held);
}

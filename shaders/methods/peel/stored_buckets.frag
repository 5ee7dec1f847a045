// Counts the layers that a bucket peel takes from a pixel: of each bucket with fragments left its nearest, and its
// furthest where that is another. Runs outside timed frames.
void main() {
    uint held = 0u;
    for (int bucket = 0; bucket < BUCKETS; ++bucket) {
        vec2 edge = texelFetch(edges, ivec3(gl_FragCoord.xy, bucket), 0).xy;
        if (edge.y >= 0.0 && edge.y <= 1.0) held += edge.y > -edge.x ? 2u : 1u;
    }
    if (held > 0u) atomicAdd(stored_fragments, held);
}

// Bucket peeling: in every bucket of the pixel's depth range, peels the nearest and the furthest fragment that are
// left, and moves the edges of the bucket inwards. The colour of a peeled fragment is stored unchanged; a bucket with a
// single fragment left matches it at one edge.
// Invariant: out_edges (MAX of (-z, z), or NONE if nothing is left) encloses the fragments that are left in the bucket.
// All passes use this one program, so that a fragment falls into the same bucket each time.
// Source: uniform buckets, Liu et al. 2009; two fragments per bucket, Vasilakis and Fudos 2013; kplus_2015 §2.
// Buffers: writes colours.
#include "scene/fragment.glsl"

const vec4 NONE = vec4(-2.0);

// Never decreases with z. The furthest fragment is in the last bucket; in a range of length zero all are in the first.
int bucket_of(float z, float nearest, float furthest) {
    float share = furthest > nearest ? (z - nearest) / (furthest - nearest) : 0.0;
    return clamp(int(share * float(BUCKETS)), 0, BUCKETS - 1);
}

void main() {
    if (rejected()) discard;
    uint p = pixel_index();
    ivec2 xy = ivec2(gl_FragCoord.xy);
    float z = gl_FragCoord.z;
    vec2 range = texelFetch(bounds, xy, 0).xy;
    int bucket = bucket_of(z, -range.x, range.y);
    vec2 edge = texelFetch(edges, ivec3(xy, bucket), 0).xy;
    bool inside = z > -edge.x && z < edge.y;
    for (int i = 0; i < BUCKETS; ++i) out_edges[i] = inside && i == bucket ? vec4(-z, z, 0.0, 0.0) : NONE;
    uint slot = (2u * uint(bucket) + uint(z != -edge.x)) * pixels + p;
    if (z == -edge.x || z == edge.y) colours[slot] = incoming().y;
}

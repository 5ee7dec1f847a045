// Blend of bucket peeling: composites the fragments just peeled into the layers of their buckets, the nearest one
// behind the front layers and the furthest one in front of the back layers. Only pixels with fragments left pass, so
// that an occlusion count of zero ends the peeling.
// Buffers: reads colours; updates layers.
#include "common/pixel.glsl"
#include "common/colour.glsl"
#include "common/transmittance.glsl"

void main() {
    uint p = pixel_index();
    bool left = false;
    for (int bucket = 0; bucket < BUCKETS; ++bucket) {
        ivec3 at = ivec3(gl_FragCoord.xy, bucket);
        vec2 edge = texelFetch(edges, at, 0).xy;
        uint front = 2u * uint(bucket) * pixels + p, back = front + pixels;
        bool peeled = edge.y >= 0.0 && edge.y <= 1.0;
        if (peeled) layers[front] = behind_of(layers[front], premultiplied(colours[front]));
        if (peeled && edge.y > -edge.x) layers[back] = stacked(behind_of(NOTHING, premultiplied(colours[back])), layers[back]);
        left = left || texelFetch(edges_current, at, 0).y >= 0.0;
    }
    if (!left) discard;
}

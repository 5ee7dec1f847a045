// Counts the pixels of which a front-to-back peel has taken a layer. Runs outside timed frames.
void main() {
    ivec2 xy = ivec2(gl_FragCoord.xy);
    if (texelFetch(layer_depth, xy, 0).x < 1.0 || texelFetch(layer, xy, 0) != vec4(0.0))
        atomicAdd(stored_fragments, 1u);
}

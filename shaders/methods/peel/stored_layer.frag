// Counts the pixels from which front-to-back peeling has taken a layer. This pass runs outside timed frames.
void main() {
    ivec2 xy = ivec2(gl_FragCoord.xy);
    if (texelFetch(layer_depth, xy, 0).x < 1.0 || texelFetch(layer, xy, 0) != vec4(0.0))
        atomicAdd(stored_fragments, 1u);
}

// Counts the layers that dual peeling takes from a pixel: the nearest fragment, and the furthest if that is a different
// one. This pass runs outside timed frames.
void main() {
    vec2 peeling = texelFetch(bounds, ivec2(gl_FragCoord.xy), 0).xy;
    if (peeling.y >= 0.0) atomicAdd(stored_fragments, peeling.y > -peeling.x ? 2u : 1u);
}

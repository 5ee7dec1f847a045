// Counts the layers that a dual peel takes from a pixel: its nearest fragment, and its furthest where that is another.
// Runs outside timed frames.
void main() {
    vec2 peeling = texelFetch(bounds, ivec2(gl_FragCoord.xy), 0).xy;
    if (peeling.y >= 0.0) atomicAdd(stored_fragments, peeling.y > -peeling.x ? 2u : 1u);
}

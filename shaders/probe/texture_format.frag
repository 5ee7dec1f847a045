// Trial of two textures of one buffer. Each pixel counts the first word of element 1, as the texture shows it. It stands
// by itself, without a prelude.
// Buffers: writes counts.
layout(binding = 0) uniform usamplerBuffer texels;
layout(std430, binding = 1) buffer Counts { uint counts[]; };
out vec4 out_colour;

void main() {
    atomicAdd(counts[min(texelFetch(texels, 1).x, 8u)], 1u);
    out_colour = vec4(1.0);
}

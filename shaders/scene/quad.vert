// One quad per instance, pixel-aligned, as a strip of four vertices.
// Invariant: the depth survives the way to window space bit for bit (it lies on a 2^-23 grid), in every program alike.
in ivec4 in_rect;   // x0 y0 x1 y1, half-open pixels
in float in_depth;  // window space
in vec4 in_rgba;    // straight alpha

invariant gl_Position;
flat out uint quad;
flat out uint payload8;  // RGBA8

void main() {
    vec2 pixel = vec2((gl_VertexID & 1) == 0 ? in_rect.x : in_rect.z, (gl_VertexID & 2) == 0 ? in_rect.y : in_rect.w);
    quad = uint(gl_InstanceID);
    payload8 = packUnorm4x8(in_rgba);
    gl_Position = vec4(2.0 * pixel / vec2(width, height) - 1.0, 2.0 * in_depth - 1.0, 1.0);
}

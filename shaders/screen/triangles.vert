// Draws triangles over the whole viewport, one per instance.
flat out uint instance;

void main() {
    instance = uint(gl_InstanceID);
    gl_Position = vec4(4.0 * float(gl_VertexID & 1) - 1.0, 4.0 * float(gl_VertexID >> 1) - 1.0, 0.0, 1.0);
}

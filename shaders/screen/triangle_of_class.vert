// Draws one triangle over the whole viewport, at the depth of a class of pixels.
#include "common/pixel_class.glsl"

void main() {
    gl_Position = vec4(4.0 * float(gl_VertexID & 1) - 1.0, 4.0 * float(gl_VertexID >> 1) - 1.0,
                       2.0 * CLASS_DEPTH(CLASS) - 1.0, 1.0);
}

// Writes the nearest and the furthest depth of a box around the scene as the depth bounds of each pixel of its rectangle.
// The box is parallel to the axes of the window, so that every pixel has the same bounds, as (-near, far).
// Source: occupancy_2015, step 1 (RenderBoundingBox).
#include "common/pixel.glsl"

void main() {
    out_bounds = vec4(-uintBitsToFloat(box_near), uintBitsToFloat(box_far), 0.0, 0.0);
}

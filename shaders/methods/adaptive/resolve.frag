// Resolve: composites the fragments of each pixel of the region, or of one class of pixels if the depth test selects
// it.
#include "common/colour.glsl"
#include "common/transmittance.glsl"
#include "methods/adaptive/cells.glsl"
#include <resolver>

void main() {
    find_cells(place());
    out_image = with_opacity(resolve_pixel());
    COUNT(empty, first_cell == end_cell)
}

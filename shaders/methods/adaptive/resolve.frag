// Resolve: composites the fragments of each pixel of the region, or of one class of pixels if the depth test selects
// it. With ASKS each pixel also tells whether it had too few cells.
// Buffers: reads counter.
#include "common/colour.glsl"
#include "common/transmittance.glsl"
#include "methods/adaptive/cells.glsl"
#include <resolver>
#if ASKS
#include "methods/adaptive/room.glsl"
#endif

void main() {
#if ASKS
    ask_for_room(counter[place()]);
#endif
    find_cells(place());
    out_image = with_opacity(resolve_pixel());
    COUNT(empty, first_cell == end_cell)
}

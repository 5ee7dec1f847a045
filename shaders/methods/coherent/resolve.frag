// Resolve as a full-screen draw: each pixel composites its fragments in the order of its tile.
// Buffers: reads tile_order.
#include "common/pixel.glsl"
#include <fetch>
#include <resolver>

uint tile;

uint ordered_slot(uint rank) {
    return tile_order[(rank + 1u) * uint(TILE_COUNT) + tile];
}

#include "methods/coherent/window.glsl"

void main() {
    uvec2 xy = uvec2(gl_FragCoord.xy) / uint(TILE);
    uint p = pixel_index();
    tile = xy.y * uint(TILE_COLUMNS) + xy.x;
    out_image = resolve_in_order(p, FETCH_COUNT(p), tile_order[tile]);
}

// Which pixels have counters and cells, row by row: with DENSE only those of the rectangle that bounds the geometry.
#include "common/pixel.glsl"

#if DENSE
#define PLACES region_pixels

uint place() {
    uvec2 xy = uvec2(gl_FragCoord.xy);
    return xy.y * region_columns + xy.x - region_first;
}
#else
#define PLACES pixels
#define place pixel_index
#endif

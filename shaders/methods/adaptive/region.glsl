// Maps a pixel to its place in per-pixel storage, row by row. With DENSE only the pixels of the rectangle that bounds
// the geometry have a place; otherwise every pixel of the viewport has one.
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

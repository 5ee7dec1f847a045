// Defines the pixels [FIRST, END) that a compute pass covers, and the square tiles that contain them, numbered row by
// row. With REGION these are the pixels of the rectangle that bounds the geometry, otherwise those of the viewport.
#if REGION
#define FIRST uvec2(region_left, region_bottom)
#define END uvec2(region_right, region_top)
#else
#define FIRST uvec2(0u)
#define END uvec2(width, height)
#endif

bool in_extent(uvec2 xy) {
    return all(greaterThanEqual(xy, FIRST)) && all(lessThan(xy, END));
}

// Columns and rows of tiles; both are 0 if the region is empty.
uvec2 tiles_in_extent() {
    if (any(equal(END, FIRST))) return uvec2(0u);
    return (END - 1u) / uint(TILE) - FIRST / uint(TILE) + 1u;
}

// Column and row, in the viewport, of the tile with this number.
uvec2 tile_in_extent(uint number) {
    uint columns = tiles_in_extent().x;
    return FIRST / uint(TILE) + uvec2(number % columns, number / columns);
}

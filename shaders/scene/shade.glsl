// Lets a pass over the geometry that draws colours read them from the words of fragments with coverage masks. It stands
// behind common/colour.glsl where the scene is rasterized into several samples a pixel.
#include "effects/shade.glsl"

#define colour_of shade_of

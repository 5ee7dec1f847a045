// Draws quads of one pixel whose words already have coverage masks, those of recorded fragments, in one sample a pixel.
#include "scene/quad.vert"

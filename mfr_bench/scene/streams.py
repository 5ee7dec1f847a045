"""Streams of the hash: one per random decision of a scene, so that none repeats another (6 is the tiles')."""

ORDER, DEPTH, COLOUR, ALPHA, PLACE_X, _, PLACE_Y, DEPTH_ORDER = range(1, 9)
BLEND, LUMINANCE, SIDE, SLANT, TILT = range(9, 14)
# Per pixel, in place of the index of a quad: how many quads it draws, and the first of them. GLSL has the same.
LAYERS_DRAWN, FIRST_DRAWN = 0xFFFFFFFF, 0xFFFFFFFE
TURN, WIGGLE, LENGTH, CUT, ROOT, TIP, SHIFT, PLACE = range(14, 22)
HILL, PIXEL, CURL, GROWTH, SPECK, SHADE = range(22, 28)

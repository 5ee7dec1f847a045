"""Numbers of effects that the float64 models here and the GLSL of shaders/effects/ share. Loads no numpy."""

from __future__ import annotations

# Parts of the word that effects on objects store in place of a colour, by their lowest bits: the object's number, one
# bit for the front of a face, red, green and blue, and 8 bits of opacity.
OBJECT_BITS, COLOUR_BITS = 5, 6
FRONT_BIT = OBJECT_BITS
RED_BIT = FRONT_BIT + 1
GREEN_BIT, BLUE_BIT = RED_BIT + COLOUR_BITS, RED_BIT + 2 * COLOUR_BITS
OPACITY_BIT = BLUE_BIT + COLOUR_BITS

# Parts of the word that fragments of multisampled scenes store in place of a colour, by their lowest bits: the coverage
# mask, a bit for each sample, and red, green, blue and opacity. Opacity is highest, as in a colour of 8 bits a channel.
MASK_BITS, SHADE_BITS = 8, 6
SHADES = (1 << SHADE_BITS) - 1

MOST_SHOWN = 16  # overlaps of a pixel, or fragments of one depth, that a channel shows in full
GREY = 0.2  # of a pixel in which nothing overlaps
LET_THROUGH = 0.9  # of the light, by each fragment of the x-ray view

DEFINES = {"OBJECT_BITS": OBJECT_BITS, "COLOUR_BITS": COLOUR_BITS, "FRONT_BIT": FRONT_BIT, "RED_BIT": RED_BIT,
           "GREEN_BIT": GREEN_BIT, "BLUE_BIT": BLUE_BIT, "OPACITY_BIT": OPACITY_BIT, "MOST_SHOWN": MOST_SHOWN,
           "GREY": GREY, "LET_THROUGH": LET_THROUGH, "MASK_BITS": MASK_BITS, "SHADE_BITS": SHADE_BITS}

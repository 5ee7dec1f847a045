"""An independent rasterizer of triangles in numpy, for small views: what a device may and may not make of them.

`bounds` gives the certain, the possible and the impossible fragments and bounds of their depths, `rules` the exact
coverage of corners that lie on the device's grid, and `deviation` compares a device's own fragments with both.
docs/accuracy.md derives the bounds.
"""

"""The figures of a result folder, drawn from the store alone and the same to the byte each time.

    files    writes them
    inputs   the digest of all that a figure is drawn from
    canvas   draws a figure once, as PNG and as SVG
    glyphs   texts as outlines
    entry    one figure from its entry in a config
    kind     what a kind declares of itself
    kinds/   the kinds, a file for each
    series   which points a figure shows
    sheet    the frame around the axes: title, legend, small print
    scales   axes
"""

from typing import TYPE_CHECKING

from ...lazy import from_modules

if TYPE_CHECKING:
    from .entry import build
    from .files import figure_paths, prepare_to_draw, render, write_all, write_figures, write_panels
    from .kinds import KINDS

__getattr__ = from_modules(__name__, {
    "KINDS": "kinds", "build": "entry", "figure_paths": "files", "prepare_to_draw": "files", "render": "files",
    "write_all": "files", "write_figures": "files", "write_panels": "files"})
__all__ = ["KINDS", "build", "figure_paths", "prepare_to_draw", "render", "write_all", "write_figures", "write_panels"]

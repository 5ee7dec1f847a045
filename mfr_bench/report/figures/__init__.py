"""The figures of a result folder, drawn from the store alone and the same to the byte each time.

    files    writes them, and says what their bytes are
    build    one figure from its entry in a config
    kind     what a kind declares of itself
    kinds/   the kinds, a file for each
    series   which points a figure shows
    sheet    the frame around the axes: title, legend, small print
    scales   axes
"""

from .build import build
from .files import figure_paths, render, write_all, write_figures, write_panels
from .kinds import KINDS

__all__ = ["KINDS", "build", "figure_paths", "render", "write_all", "write_figures", "write_panels"]

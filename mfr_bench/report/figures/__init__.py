"""The figures of a result folder, drawn from the store alone and the same to the byte each time.

    files    writes them, and says what their bytes are
    kinds    the kinds that a config may ask for, and their options
    series   which points a figure shows
    sheet    the frame around the axes: title, legend, small print
    scales   axes
    bars, lines   a kind or two each
"""

from .files import figure_paths, render, write_figures, write_together
from .kinds import KINDS, build

__all__ = ["KINDS", "build", "figure_paths", "render", "write_figures", "write_together"]

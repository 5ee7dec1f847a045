"""A result folder as tables: images, time, ratio to the floor, memory, passes, and what was not measured.

    grid     a table of text
    fields   what a field says of a point
    blocks   tables of measures, methods by the values of an axis
    places   whose place among the methods changes along an axis
    nodes    equal devices of one folder, and how far apart they are
    checks   tables of images, of what breaks, of the paper's numbers
    pages    all tables as text, and as results.md
    files    the files in tables/
    paper    the same for a paper: LaTeX, and CSV for siunitx
"""

from .fields import noise_text
from .files import write_tables
from .grid import Grid
from .pages import WIDTH, breaking_text, markdown, terminal_table
from .paper import write_for_paper

__all__ = ["WIDTH", "Grid", "breaking_text", "markdown", "noise_text", "terminal_table", "write_for_paper",
           "write_tables"]

"""Two sets of results, cell by cell: what became faster, slower, wrong or larger, and what cannot be told.

    sides     the two sets as cells by what they are, and why they may not be compared
    few       how far the median of few samples may be from the cell's own
    noise     how far two runs of the same thing are apart, as the cells themselves show it
    judge     the verdict on each cell
    present   verdicts as text, Markdown, CSV and JSON

docs/measurement.md states the statistics.
"""

from . import present
from .judge import Comparison, compare
from .sides import load_side

__all__ = ["Comparison", "compare", "load_side", "present"]

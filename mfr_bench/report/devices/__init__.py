"""One experiment on many devices: how each method stands on each, and how the devices differ.

    digest    what a comparison needs of a folder's cells, from them or from the file that a merge left
    reading   the digests of all folders, read by several processes
    standing  ratios to the fastest and ranks of the methods on each device, with intervals
    differs   what differs between the devices besides their times
    answer    the best on the worst device, and what is near the best on all
    text      all of it as text, Markdown and JSON
    figures   ratios and ranks by device
    bands     of many devices, quantiles of the ratios along an axis
    together  all figures and tables of experiments that several devices measured

Memory and time grow with the number of cells alone: a thousand devices are read one after another, and of each only its
times, errors and memory are kept.
"""

from .answer import Answer, Limits, answers
from .digest import write_digest
from .reading import Experiment, read_experiments
from .text import answers_json, answers_text, as_text
from .together import write_together

__all__ = ["Answer", "Experiment", "Limits", "answers", "answers_json", "answers_text", "as_text", "read_experiments",
           "write_digest", "write_together"]

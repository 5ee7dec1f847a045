"""A result folder as tables and figures see it: labelled points with coordinates and measures.

    words     names of coordinates and values, as people write them
    measures  what a figure can show, and the labels of its axes
    point     one cell
    result    the points of a folder, and the axes along which they lie
    reading   results from folders
"""

from .measures import IN_MIB, MEASURES, NOTHING, column_of, drawn_measure
from .point import LOSES_TIES, Point, is_floor, time_ratio
from .reading import join, load
from .result import Result, scene_words, series, values, without_record
from .words import bare, figure_of, heading, listed, number, percent, plain, short

__all__ = ["IN_MIB", "LOSES_TIES", "MEASURES", "NOTHING", "Point", "Result", "bare", "column_of", "drawn_measure",
           "figure_of", "heading", "is_floor", "join", "listed", "load", "number", "percent",
           "plain", "scene_words", "series", "short", "time_ratio", "values", "without_record"]

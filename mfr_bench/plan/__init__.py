"""Experiments -> cells in the order that shares most work, and what a device or a budget forbids. Pure.

    cells        the points of an experiment, each once
    expected     the statistics that a scene should have
    limits       what a device, a method or a budget forbids
    predicted    cells that would time out, by smaller ones that did
    forecast     how long a run will take
    time_left    the same while it goes on
    ending       what follows its last cell
"""

from .cells import Cell, expand
from .expected import expected_stats
from .limits import Decision, Limits, features_for, forbidden, judge, overview
from .predicted import NOT_TRIED, CellOutcome, Outcomes, predicted_timeout

__all__ = [
    "NOT_TRIED",
    "Cell",
    "CellOutcome",
    "Decision",
    "Limits",
    "Outcomes",
    "expand",
    "expected_stats",
    "features_for",
    "forbidden",
    "judge",
    "overview",
    "predicted_timeout",
]

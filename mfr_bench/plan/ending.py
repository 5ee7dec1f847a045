"""Foretells what follows the last cell of a run: the second calibration, tables and figures. Pure."""

from __future__ import annotations

import math

# Of a quiet machine, by the results of 65 experiments with 2 to 230 cells: processor time, and what disks take.
IMPORTS_S = 0.2  # of what tabulates and draws
TABLES_S = 0.07  # of an experiment
FIGURE_S = 0.13
CELL_S = 0.003  # of tables and figures, for each cell
EMPTY_S = 0.04  # of tables and figures of an experiment without any cell
LEAST_S = 0.1  # to measure a cell: 24 s for 146 of them, programs compiled, with the start of the command
SAFE = 2.0  # times what it should take is set aside for it, where it has to be in time


def reports_s(experiments: int, figures: int, cells: int, processes: int = 1, empty: int = 0) -> float:
    """Seconds that tables and figures take on a quiet machine.

    figures: of all these experiments, drawn by so many processes. empty: further experiments, which have no cell.
    """
    drawn_s = FIGURE_S * figures + CELL_S * cells + EMPTY_S * empty
    return IMPORTS_S * bool(experiments) + TABLES_S * experiments + drawn_s / processes


def measurable(cells: int, seconds: float, slowness: float) -> int:
    """How many of these cells, at most, can be measured in so many seconds; slowness as in `ending_s`."""
    return min(cells, math.ceil(seconds / (slowness * LEAST_S)))


def ending_s(reports: float, calibrated_s: float, slowness: float) -> float:
    """Seconds from the last cell to the end of the command.

    reports: of `reports_s`. calibrated_s: of the first calibration. slowness: how many times as long the machine takes
    as a quiet one.
    """
    return calibrated_s + slowness * reports

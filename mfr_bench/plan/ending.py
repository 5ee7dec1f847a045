"""Foretells what follows the last cell of a run: the second calibration, tables and figures. Pure."""

from __future__ import annotations

# Of a quiet machine, by the manifests of 39 runs.
TABLES_S = 0.3  # of an experiment, with the imports of what draws
FIGURE_S = 0.25
CELL_S = 0.005  # of tables and figures, for each cell
SAFE = 2.5  # times what it should take is set aside for it, where it has to be in time


def reports_s(experiments: int, figures: int, cells: int, processes: int = 1) -> float:
    """Seconds that tables and figures take on a quiet machine.

    figures: of all experiments, drawn by so many processes.
    """
    return TABLES_S * experiments + (FIGURE_S * figures + CELL_S * cells) / processes


def ending_s(reports: float, calibrated_s: float, slowness: float) -> float:
    """Seconds from the last cell to the end of the command.

    reports: of `reports_s`. calibrated_s: of the first calibration. slowness: how many times as long the machine takes
    as a quiet one.
    """
    return calibrated_s + slowness * reports

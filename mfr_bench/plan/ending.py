"""Foretells what follows the last cell of a run: the second calibration, tables and figures. Pure."""

from __future__ import annotations

# Of a quiet machine, by the manifests of 39 runs.
TABLES_S = 0.3  # of an experiment, with the imports of what draws
FIGURE_S = 0.25
CELL_S = 0.005  # of tables and figures, for each cell


def ending_s(experiments: int, figures: int, cells: int, calibrated_s: float, slowness: float,
             processes: int = 1) -> float:
    """Seconds from the last cell to the end of the command.

    figures: of all experiments, drawn by so many processes. calibrated_s: of the first calibration. slowness: how many
    times as long the machine takes as a quiet one.
    """
    reports_s = TABLES_S * experiments + (FIGURE_S * figures + CELL_S * cells) / processes
    return calibrated_s + slowness * reports_s

"""The names that a figure of a config may draw, by the table of columns and the kind of the figure."""

from ..store.columns import ARRAYS, COLUMNS, DERIVED, PASS_COLUMNS, names

IDENTITY = names(COLUMNS, "place")
MEASURED = names((*COLUMNS, *DERIVED), "measure", "error", "cost")
# y of a kind of figure, where it is not any of MEASURED; x, where it is not anything.
MEASURED_BY_KIND = {"stacked_passes": names(PASS_COLUMNS, "measure"), "maps": tuple(ARRAYS), "histogram": ("time_ms",),
                    "pareto": names(COLUMNS, "error"), "heat": (*MEASURED, "best_ratio"), "work": ("time_ms",)}
ALONG_BY_KIND = {"pareto": names((*COLUMNS, *DERIVED), "cost")}

"""The names that a figure of a config may draw, by the table of columns."""

from ..store.columns import COLUMNS, DERIVED, names

IDENTITY = names(COLUMNS, "place")
MEASURED = names((*COLUMNS, *DERIVED), "measure", "error", "cost")

"""Result folders: one durable file per cell, a manifest, and the CSV files derived from them; see docs/results.md."""

from .columns import COLUMNS, PASS_COLUMNS, Column
from .files import remove_parts, unwritable, write_file
from .folder import ResultFolder, find_results
from .record import KEY_FILE, SCHEMA, Cell, failed_trials, fault, key, places
from .rows import Floors, Row, Texts, csv_text, derive, device_name, pass_rows, result_rows
from .status import STATUSES, Status

__all__ = ["COLUMNS", "KEY_FILE", "PASS_COLUMNS", "SCHEMA", "STATUSES", "Cell", "Column", "Floors", "ResultFolder",
           "Row", "Status", "Texts", "csv_text", "derive", "device_name", "failed_trials", "fault", "find_results",
           "key", "pass_rows", "places", "remove_parts", "result_rows", "unwritable", "write_file"]

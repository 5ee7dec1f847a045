"""docs/results.md: the files of a result folder, their columns, and the history of the format, from the tables here."""

from __future__ import annotations

from collections.abc import Iterable

from ..markdown import filled, markdown_table
from .columns import ARRAYS, COLUMNS, DERIVED, PASS_COLUMNS, Column
from .record import HISTORY, SCHEMA
from .status import STATUSES

HEAD = f"""# Result folders

What is in a folder that `mfr-bench run` wrote (`mfr-bench table --columns` prints this page). An empty field was
not measured; it is never 0.

The format has schema {SCHEMA}, which every cell file and manifest states. A file of a later schema is left in place and
not used, and a run into its folder is refused. The history of the format:
"""

FILES = """
## Files

| file | what |
| --- | --- |
| `manifest.json` | the config, the device, versions, calibration, the planned cells in order, where the time went |
| `cells/<key>.json` | one measured cell, every raw sample included; written whole, renamed into place |
| `cells/<key>.npz` | the arrays that the cell keeps, where `measure.keep` asks for them |
| `cells.zip` | both, packed by `mfr-bench pack`; a file in cells/ is used before the one of its name in the pack |
| `replicates/<key>.<hash>.json` | records of one cell that equal devices gave, where `mfr-bench merge` joined them |
| `unfinished.jsonl` | samples of cells that a killed run did not finish, a line per batch; gone when they are |
| `results.csv` | a row per cell: every cell in the folder |
| `passes.csv` | a row per cell and timed pass |
| `tables/results.md` | the tables that `mfr-bench table` prints, and the pass times |
| `tables/summary.csv` | a row per cell that the config has, by label and place on each axis: what tables show |
| `tables/pass_times.csv` | a row per such cell, a column per pass: median times in ms |
| `comparison.json` | by `merge`: what comparing devices reads of cells; used while manifest and cells are the same |
| `figures/<name>.png`, `.svg` | the config's figures; with a digest of their inputs, PNGs with their small print |

In `tables/summary.csv` the column `exact` says that an image is as promised: `max_abs_error` is at most 1e-4, and the
status is not `wrong`. What is promised may be the image of fewer fragments, as by a k-buffer, and where equal depths
meet by chance a method that loses them by nature keeps its promise without them
([scenes.md](scenes.md#equal-depths)); `tied_error` then tells how much that is. The word `exact` of tables is stricter:
it stands where the image is that of all fragments.

A cell whose scene moves, or whose method chooses k from the scene, has `frames` in its file. For each of them:
`frame` (from 0), `fragments`, `covered_pixels`, `max_fragments`, `chosen_k` (null where nothing is chosen), `kept`
(fragments that the method keeps of the frame) and `histogram` (pixels with 0, 1, 2, … fragments).
"""

COLUMNS_HEAD = """
## Columns of results.csv

`figures` says what a figure of a config may do with a column: a `place` is x, panels or rows; a `measure` is also y; a
frontier has an `error` as y and a `cost` as x.
"""


STATUSES_HEAD = """
## Statuses

`image` says whether the cell was measured to its end, and with which image. A `refused` cell says nothing against its
method. A `retried` one is measured again by the next run, as is one that a device cannot have because it fails its
self-tests ([drivers.md](drivers.md)). A `failed` one counts as worse in `compare`. `over memory` means that there was
not enough of it: line charts draw a cross. A run ends with the highest `exit status` of its cells. `breaks` is the
fault that `mfr-bench stress` shows; where it is empty, image and counts decide.
"""


def columns_page() -> str:
    """The page, as docs/results.md has it."""
    history = [filled(f"{schema}: {what}", "- ") for schema, what in HISTORY.items()]
    arrays = [(f"`{a.name}`", a.type, str(a.dimensions), a.meaning) for a in ARRAYS.values()]
    parts = [HEAD, *history, FILES, COLUMNS_HEAD, *_columns(COLUMNS),
             "\n## Measures derived from them, for figures and tables\n", *_columns(DERIVED),
             "\n## Columns of passes.csv\n", *_columns(PASS_COLUMNS), STATUSES_HEAD, *_statuses(),
             "\n## Arrays\n", *markdown_table(("array", "type", "dimensions", "what"), arrays)]
    return "\n".join(parts) + "\n"


def _columns(columns: Iterable[Column]) -> list[str]:
    return markdown_table(("column", "type", "unit", "meaning", "figures", "axis", "from"), (
        (f"`{c.name}`", c.type, c.unit, c.meaning, c.drawn, c.axis if c.drawn not in ("", "place") else "",
         f"`{c.producer}`") for c in columns))


def _statuses() -> list[str]:
    head = ("status", "meaning", "image", "refused", "retried", "failed", "over memory", "exit status", "breaks")
    rows = ((f"`{s.name}`", s.meaning, s.image, *map(_yes, (s.refused, s.retried, s.failed, s.over_memory)),
             str(s.exit_status), s.breaks) for s in STATUSES.values())
    return markdown_table(head, rows)


def _yes(value: bool) -> str:
    return "yes" if value else ""

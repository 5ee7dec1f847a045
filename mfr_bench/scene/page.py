"""The parts of docs/scenes.md that the kinds of scenes say of themselves."""

from __future__ import annotations

from ..markdown import markdown_table
from .kinds import KINDS

BEGIN, END = "<!-- kinds: mfr-bench configs --kinds -->", "<!-- end of kinds -->"
HEADER = ("kind", "what", "depth_complexity", "mean depth", "stands for")


def kinds_page() -> str:
    """A table of all kinds and layouts, and the keys of each kind that has its own; Markdown between BEGIN and END."""
    rows = [(row.name, row.what, row.depth_complexity, row.mean_depth, row.stands_for)
            for kind in KINDS.values() for row in kind.rows]
    keys = [f"\n## Keys of `kind: {name}`\n\n{kind.key_words.rstrip()}"
            for name, kind in KINDS.items() if kind.key_words]
    return "\n".join([BEGIN, *markdown_table(HEADER, rows), *keys, END]) + "\n"

"""Tables and prose in Markdown."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Sequence

COLUMNS = 120  # of a line of prose, at most
WHOLE = re.compile(r"`[^`]*`|\[[^\]]*\](?:\([^)]*\))?")  # code and links, in which no line ends
OPENS = re.compile(r" (?=(?:[-+*#>]|\d+[.)])\s|%)")  # before what would open a list, a heading, a quotation; before %
HELD = "\N{NO-BREAK SPACE}"  # stands for a space while lines are broken


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]], left: int | None = None) -> list[str]:
    """The lines of a table, pipes escaped. Columns from the number `left` on are aligned to the right; None: none."""
    rule = ["---" if left is None or at < left else "---:" for at in range(len(head))]
    return [_row(head), _row(rule), *map(_row, rows)]


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def filled(text: str, lead: str = "") -> str:
    """A paragraph in lines of COLUMNS at most. lead: what its first line begins with, such as the dash of a list."""
    held = OPENS.sub(HELD, WHOLE.sub(lambda found: found[0].replace(" ", HELD), text))
    return textwrap.fill(held, COLUMNS, initial_indent=lead, subsequent_indent=" " * len(lead),
                         break_long_words=False, break_on_hyphens=False).replace(HELD, " ")

"""Tables in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]], left: int | None = None) -> list[str]:
    """The lines of a table, pipes escaped. Columns from the number `left` on are aligned to the right; None: none."""
    rule = ["---" if left is None or at < left else "---:" for at in range(len(head))]
    return [_row(head), _row(rule), *map(_row, rows)]


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"

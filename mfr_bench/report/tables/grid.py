"""A table of text, laid out for a terminal or as Markdown."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass, replace

LABEL_WIDTH = 34
ABSENT = "–"  # a cell that was never measured
NO_ROWS = "None."  # in place of a header without rows


@dataclass(frozen=True)
class Grid:
    """A table of text: `rows` have as many fields as `header`; the first is the row's name."""

    title: str
    note: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    left: int = 1  # columns set flush left

    def __post_init__(self) -> None:
        for name, rows in (("header", (self.header,)), ("rows", self.rows)):
            one_line = tuple(tuple(" ".join(field.splitlines()) for field in row) for row in rows)
            object.__setattr__(self, name, one_line if name == "rows" else one_line[0])

    def chunks(self, width: int) -> Iterable[Grid]:
        """The grid in pieces of whole columns, each at most `width` wide and with the first column."""
        if not self.rows:
            yield self
            return
        lengths = self.lengths()
        start = 1
        while start < len(self.header) or start == 1:
            end, used = start, lengths[0] + 4
            while end < len(lengths) and (end == start or used + lengths[end] + 3 <= width):
                used, end = used + lengths[end] + 3, end + 1
            yield replace(self, header=self._piece(self.header, start, end), left=max(1, self.left - start + 1),
                          rows=tuple(self._piece(row, start, end) for row in self.rows))
            start = max(end, start + 1)

    @staticmethod
    def _piece(row: tuple[str, ...], start: int, end: int) -> tuple[str, ...]:
        return row[0], *row[start:end]

    def lengths(self) -> list[int]:
        return [max(map(len, column)) for column in zip(self.header, *self.rows, strict=True)]

    def aligned(self) -> list[list[str]]:
        lengths = self.lengths()
        return [[field.ljust(width) if i < self.left else field.rjust(width)
                 for i, (field, width) in enumerate(zip(row, lengths, strict=True))]
                for row in (self.header, *self.rows)]

    def text(self) -> str:
        """The table as plain text; a word in place of one without rows."""
        if not self.rows:
            return NO_ROWS
        header, *rows = ("   ".join(fields).rstrip() for fields in self.aligned())
        return "\n".join([header, "-" * len(header), *rows])

    def markdown(self) -> str:
        """The table as Markdown; a word in place of one without rows."""
        if not self.rows:
            return NO_ROWS
        header, *rows = (tuple(field.replace("|", "\\|") for field in row) for row in (self.header, *self.rows))
        escaped = replace(self, header=header, rows=tuple(rows))
        lines = [f"| {' | '.join(fields)} |" for fields in escaped.aligned()]
        rule = "|".join(f":{'-' * (w + 1)}" if i < self.left else f"{'-' * (w + 1)}:"
                        for i, w in enumerate(escaped.lengths()))
        return "\n".join([lines[0], f"|{rule}|", *lines[1:]])


def cut(label: str) -> str:
    """The label, cut at LABEL_WIDTH characters."""
    return label if len(label) <= LABEL_WIDTH else f"{label[:LABEL_WIDTH - 1]}…"


def bulleted(lines: Iterable[str], width: int) -> list[str]:
    """Items of a list, each wrapped at so many columns."""
    return [part for line in lines for part in
            textwrap.wrap(line, width, initial_indent="- ", subsequent_indent="  ", break_on_hyphens=False)]

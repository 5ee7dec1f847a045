"""Help and complaints on a terminal of any width: no word and no option is broken, where it fits a line."""

from __future__ import annotations

import re
import textwrap

import click

HANGING = 4  # columns before the rest of a line that does not fit
HELD = "\N{NON-BREAKING HYPHEN}"  # stands for a hyphen while lines are broken


def wrapped(line: str, columns: int) -> str:
    """The line in as many as it takes, the rest below its second column if it has one; one that fits stays as it is."""
    if len(line) <= columns:
        return line
    first, second = (re.match(pattern, line).group() for pattern in (r" *", r"( *\S.*?  +(?=\S))?"))
    words = textwrap.TextWrapper(columns - len(second), break_long_words=False, break_on_hyphens=False)
    if 0 < len(second) <= columns / 2:
        return second + f"\n{' ' * len(second)}".join(words.wrap(line[len(second):]))
    words.width, words.initial_indent, words.subsequent_indent = columns, first, first + " " * HANGING
    return words.fill(line.strip())


class Formatter(click.HelpFormatter):
    """click's, but for hyphens, at which it breaks words, and for long lines, which it lets the terminal break."""

    def write_usage(self, prog: str, args: str = "", prefix: str | None = None) -> None:
        super().write_usage(prog, args.replace("-", HELD), prefix)

    def write_text(self, text: str) -> None:
        super().write_text(text.replace("-", HELD))

    def write_dl(self, rows, col_max: int = 30, col_spacing: int = 2) -> None:
        super().write_dl([(name, text.replace("-", HELD)) for name, text in rows], col_max, col_spacing)

    def getvalue(self) -> str:
        text = super().getvalue().replace(HELD, "-")
        return "\n".join(wrapped(line, self.width) for line in text.split("\n"))

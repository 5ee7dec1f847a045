"""What a page says that a command prints, held against what it prints.

A block of the language `console` has commands behind `$ ` and below each what it prints; a line of `…` stands for any
lines. Not compared are what differs from run to run and from machine to machine: durations, measured times and ratios
with their intervals, the noise floor, where the time went, errors in floats, the device's folder, the width of columns,
and the order of the rows of a table, which may be that of times.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

PROMPT, ANY = "$ ", "…"
MEASURED = (
    r"≈ [\d.]+ \[[\d.]+, [\d.]+\]",  # a ratio with its interval
    r"\d[\d.,]* ±(?:\?|\d\S* %)(?: ~)?",  # a time or a ratio with half of its interval
    r"\bfastest(?=\s{2,}|$)",  # stands for the ratio 1 in the row that has it
    r"\b\d[\d.,]* (?:CPU )?(?:ms|s|min|h)\b",
    r"(?<=noise floor )\d[\d.,]* %",
    r"\b\d[\d.]*e-\d+",
    r"(?<=results/)[^/\s]+(?=/)",
    r"(?<=device busy with frames )\d.*",
)


def steps(text: str) -> Iterator[tuple[str, str]]:
    """Each command of a console's block, and the text below it."""
    command, printed = "", []
    for line in text.splitlines():
        if line.startswith(PROMPT):
            yield from [(command, "\n".join(printed))] if command else []
            command, printed = line.removeprefix(PROMPT), []
        else:
            printed.append(line)
    yield from [(command, "\n".join(printed))] if command else []


def agrees(page: str, printed: str) -> bool:
    """Whether a command prints what the page says."""
    lines = ("(?:[^\n]*\n)*?" if line == ANY else re.escape(line) + "\n" for line in comparable(page))
    return re.fullmatch("".join(lines), "".join(f"{line}\n" for line in comparable(printed))) is not None


def comparable(text: str) -> list[str]:
    """The lines without what is measured; the rows of a table in alphabetical order."""
    found: list[str] = []
    rows: list[str] | None = None
    for given in [*text.strip("\n").splitlines(), ""]:
        line = " ".join(re.sub("|".join(MEASURED), "#", given).split())
        if rows is not None and line not in ("", ANY):
            rows.append(line)
            continue
        found += sorted(rows or [])
        rows = [] if set(line) == {"-"} else None
        found.append(re.sub("^-+$", "---", line))
    return found[:-1]

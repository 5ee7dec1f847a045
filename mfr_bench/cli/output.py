"""Prints what commands say. A reader that stops reading ends the output, never the work or its exit status."""

from __future__ import annotations

import os
import shutil
import sys
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from . import alive

WIDEST = 120  # columns that text is laid out for, at most and where nothing says how wide the terminal is
NARROWEST = 40


def width() -> int:
    """Columns to lay text out for: the terminal's, within bounds."""
    return max(NARROWEST, min(WIDEST, shutil.get_terminal_size((WIDEST, 24)).columns))


def ending(out: str, *endings: str, option: str = "--out") -> str:
    """The ending of a file's name, whatever its case. Raises UsageError where it is none of these."""
    from ..errors import UsageError

    found = Path(out).suffix.lower()
    if found not in endings:
        raise UsageError(f"{option}: {out!r} has another ending; allowed: a file that ends in {' or '.join(endings)}")
    return found


def place(point: Mapping[str, Any]) -> str:
    """The place of a cell in its sweep: 'size=96×96 k=8'."""
    from ..report.data import plain

    return " ".join(f"{name.removeprefix('scene.')}={plain(value)}" for name, value in point.items())


def say(text: object) -> None:
    """Print on stdout. Once its reader has gone (`| head -1`), nothing more is printed."""
    alive.end()
    try:
        click.echo(text)
    except BrokenPipeError:
        _silence(1)


def note(text: object) -> None:
    """Print on stderr, for whoever may be watching; a failure to write it stops nothing.

    A line stays one, but on a terminal that is too narrow for it.
    """
    from .layout import wrapped

    alive.end()
    try:
        click.echo(wrapped(str(text), width()) if sys.stderr.isatty() else text, err=True)
    except OSError:
        _silence(2)


def say_lines(text: str) -> None:
    """Print lines that may have columns; on a terminal that is too narrow for one, the rest below its second column."""
    from .layout import wrapped

    say("\n".join(wrapped(line, width()) for line in text.split("\n")) if sys.stdout.isatty() else text)


def write_text(path: str, text: str) -> None:
    """Write a file of the user's choice, with the folders that it needs. Raises StoreError."""
    from ..store import write_file

    write_file(Path(path), text.encode())


def append_text(path: str, text: str) -> None:
    """Append to a file of the user's choice, which others may have begun. Raises StoreError."""
    from ..errors import StoreError

    try:
        with open(path, "a", encoding="utf-8") as file:
            file.write(text.rstrip("\n") + "\n")
    except OSError as error:
        raise StoreError(f"{path}: cannot be written: {error.strerror}") from None


def _silence(descriptor: int) -> None:
    """Send what is written to the descriptor from now on, and what is still buffered, nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, descriptor)
    os.close(nowhere)


def let_go_of_stdout() -> None:
    """Send nowhere what could not be written: Python 3.13 and later try again as they end, and end with 120."""
    try:
        sys.stdout.flush()
    except OSError:
        _silence(1)


def prepare_streams() -> None:
    """Let every process print: a character that its encoding lacks as '?', and to nowhere where a stream is closed.

    The next file to be opened would else get the number of the closed stream, and its prints. A warning is a line
    without the place in the source that it comes from.
    """
    warnings.showwarning = lambda message, *_: note(message)
    for descriptor, name in ((1, "stdout"), (2, "stderr")):
        stream = getattr(sys, name)
        if stream is not None:
            stream.reconfigure(errors="replace")
        else:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            if nowhere != descriptor:
                os.dup2(nowhere, descriptor)
                os.close(nowhere)
            setattr(sys, name, open(descriptor, "w"))  # noqa: SIM115 - open until the process ends

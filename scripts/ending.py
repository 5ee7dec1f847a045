"""Ends a script in one line on stderr and an exit status, where a user, a file or a reader of its output ends it."""

from __future__ import annotations

import argparse
import multiprocessing
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import NoReturn

FAILED, MISUSED, INTERRUPTED, UNREAD = 1, 2, 130, 141  # exit status; the last as a shell says it of a closed pipe


def _uncaught(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """Tell Ctrl-C while modules are still being loaded in a line, which processes beside the first one leave to it."""
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)
    elif multiprocessing.parent_process() is None:
        _said("interrupted", INTERRUPTED)


sys.excepthook = _uncaught


class Misuse(Exception):  # noqa: N818 - what the user did; the message says what is allowed
    """An option or a folder is not what the script needs."""

    exit_status = MISUSED


def run_script(main: Callable[[], int | None]) -> NoReturn:
    """Run a script, and exit with the status that it returns.

    A file that cannot be read or written, a command of its own that fails and an error that knows its exit status, as
    those of mfr_bench do, end it with one line; Ctrl-C with 130, and a reader that stops reading without a word.
    """
    try:
        status = _status(main)
    except KeyboardInterrupt:
        status = _said("interrupted", INTERRUPTED)
    except BrokenPipeError:
        status = UNREAD
    except OSError as error:
        status = _said(f"{error.filename or 'the output'}: {error.strerror or error}", FAILED)
    except subprocess.CalledProcessError as error:
        status = _said(f"{' '.join(map(str, error.cmd))}: exit status {error.returncode}", FAILED)
    except Exception as error:
        if not hasattr(error, "exit_status"):
            raise
        status = _said(str(error), error.exit_status)
    _let_go_of_stdout()
    sys.exit(status)


def _status(main: Callable[[], int | None]) -> int:
    """What the script returns, or exits with, when all is written that it printed."""
    try:
        status = main() or 0
    except SystemExit as ended:
        if isinstance(ended.code, str):
            return _said(ended.code, FAILED)
        status = ended.code or 0
    sys.stdout.flush()
    return status


def _said(text: str, status: int) -> int:
    print(f"{Path(sys.argv[0]).stem}: {text}", file=sys.stderr)
    return status


def _let_go_of_stdout() -> None:
    """Send nowhere what could not be written: Python would try again as it ends."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def at_least(least: int) -> Callable[[str], int]:
    """The type of an option for argparse: a whole number from `least` on."""
    def number(text: str) -> int:
        try:
            if (found := int(text)) >= least:
                return found
        except ValueError:
            pass
        raise argparse.ArgumentTypeError(f"{text!r} is not allowed; allowed: a whole number, {least} or more")

    return number

"""Progress of a run on stderr: a live line on a terminal, a line per cell in a log."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from ..store.status import STATUSES
from . import alive
from .output import note, place

if TYPE_CHECKING:
    from ..plan.time_left import TimeLeft
    from ..run.events import Begun, Sampled

ENOUGH = 0.1  # of what was foretold at the start; while less is over, the time left is marked as a forecast
STOPPING = "stopping; Ctrl-C again ends at once"
PULSE_S = 2.0  # between two lines of a race in a log, whose cells end late and many at once


def exact_duration(seconds: float) -> str:
    """'40 s', '3 min 05 s', '2 h 30 min', for what passes while it is read; a forecast has fewer digits."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes:02} min"
    return f"{minutes} min {rest:02} s" if minutes else f"{rest} s"


def outcome(row: Mapping[str, Any]) -> str:
    """One line on a finished cell: method, where it stands in the sweep, time or reason."""
    time_ms = row["values"].get("time_ms")
    said = ([] if row["status"] == "ok" else [row["status"]]) + ([row["reason"]] if row["reason"] else [])
    said += [] if time_ms is None else [f"{time_ms:.3g} ms"]
    return f"{' '.join([row['label'], place(row['point'])]).rstrip()}: {', '.join(said)}"


class Progress:
    """Counts rows of `total` as they come. On a terminal rows that failed stay on the screen.

    `asked` says whether the user has asked the work to stop. quiet: nothing is printed. foretell: makes what the run
    will take, at the first event, when the process that measures is at work. until: when measuring has to stop, on the
    monotonic clock. pulse_s: in a log a line tells how far the cells are whenever none has ended for so long.
    """

    def __init__(self, total: int, name: str, asked: Callable[[], bool] = lambda: False, quiet: bool = False,
                 foretell: Callable[[], TimeLeft] | None = None, until: float = float("inf"),
                 pulse_s: float = float("inf")):
        self.total, self.name, self.asked, self.quiet, self.done = total, name, asked, quiet, 0
        self.ahead, self._foretell, self._until = None, foretell, until
        self._last, self._start = "starting", time.monotonic()
        self._pulse_s, self._told_s, self._begun = pulse_s, self._start, set[str]()
        self._learning = threading.Lock()  # a thread redraws the line; what it reads must not change meanwhile
        self._live = _live_line(self._text) if total and not quiet else None

    def __enter__(self):
        if self._live:
            alive.end()
            self._live.start(refresh=True)
        return self

    def __exit__(self, *_: object) -> None:
        if self._live:
            with suppress(OSError):  # the terminal may be gone
                self._live.stop()

    @property
    def _elapsed_s(self) -> float:
        return time.monotonic() - self._start

    def row(self, row: Mapping[str, Any]) -> None:
        """A cell is done."""
        self._begin()
        self.done += 1
        self._begun.add(row["key"])
        if self.ahead:
            with self._learning:
                self.ahead.done(row["key"], row, self._elapsed_s)
        self._last = outcome(row)
        if self.quiet:
            return
        if self._live is None:
            self._note()
        elif STATUSES[row["status"]].failed:
            with suppress(OSError):
                self._live.console.print(self._last, markup=False, highlight=False)

    def saw(self, event: Begun | Sampled) -> None:
        """A phase of a cell begins, or samples of it are there."""
        from ..run.events import Begun

        self._begin()
        if self.ahead:
            with self._learning:
                if isinstance(event, Begun):
                    self.ahead.began(event.key, event.phase, self._elapsed_s)
                else:
                    self.ahead.sampled(event.key, event.samples_ms)
        self._last = self._last if self.done else "measuring"
        if isinstance(event, Begun) and event.key:
            self._begun.add(event.key)
        if self._live is None and not self.quiet and time.monotonic() - self._told_s >= self._pulse_s:
            begun = len(self._begun)
            self._last = "drawing in turns" if begun >= self.total else f"{begun} of {self.total} begun"
            self._note()

    def _note(self) -> None:
        """Print the line into a log."""
        self._told_s = time.monotonic()
        note(self._line())

    def _begin(self) -> None:
        """Tell what the run will take, once there is an event."""
        if self._foretell:
            self.ahead, self._foretell = self._foretell(), None
            if self._live:
                with suppress(OSError):
                    self._live.refresh()

    def _line(self) -> str:
        known = self.ahead or self._until < float("inf")
        left = f", {self._left}" if known and self.done < self.total else ""
        return f"{self.name} {self.done}/{self.total}{left}  {STOPPING if self.asked() else self._last}"

    @property
    def _left(self) -> str:
        if self.ahead is None:
            return f"{exact_duration(max(0.0, self._until - time.monotonic()))} left to measure"
        with self._learning:
            left_s, share = self.ahead.left_s(self._elapsed_s), self.ahead.share
        most_s = max(0.0, self._until - time.monotonic()) + self.ahead.end_s
        if most_s < left_s:
            return f"{exact_duration(most_s)} left of the time budget"
        left = f"{exact_duration(left_s)} left"
        return left if share >= ENOUGH else f"forecast: {left}"

    def _text(self):
        from rich.text import Text

        return Text(f"{exact_duration(self._elapsed_s)}  {self._line()}", overflow="ellipsis", no_wrap=True)


def _live_line(text: Callable[[], Any]):
    """A line at the bottom of a terminal, redrawn four times a second; None where stderr is no terminal that can."""
    if not sys.stderr.isatty():
        return None
    from rich.console import Console
    from rich.live import Live

    console = Console(stderr=True)
    if console.is_dumb_terminal:
        return None
    return Live(console=console, refresh_per_second=4, transient=True, get_renderable=text)

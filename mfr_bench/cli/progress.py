"""Progress of a run on stderr: a live line on a terminal, a line per cell in a log."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from typing import Any


def duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02} s" if minutes else f"{rest} s"


def outcome(row: Mapping[str, Any]) -> str:
    """One line on a finished cell: method, where it stands in the sweep, time or reason."""
    point = " ".join(f"{name.removeprefix('scene.')}={value}" for name, value in row["point"].items())
    time_ms = row["values"].get("time_ms")
    said = f"{time_ms:.3g} ms" if time_ms is not None else row["reason"]
    status = "" if row["status"] == "ok" else f" {row['status']}"
    return f"{row['label']} {point}:{status} {said}".replace(" :", ":")


class Progress:
    """Counts rows of `total` as they come. `note` lines stay on the screen."""

    def __init__(self, total: int, name: str):
        self.total, self.name, self.done = total, name, 0
        self._start = time.monotonic()
        self._live = None
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.live import Live

            self._live = Live(console=Console(stderr=True), refresh_per_second=4, transient=True)

    def __enter__(self) -> Progress:
        if self._live:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live:
            self._live.stop()

    @property
    def left_s(self) -> float | None:
        """Time left if the remaining cells take what the done ones took."""
        spent = time.monotonic() - self._start
        return spent / self.done * (self.total - self.done) if self.done else None

    def row(self, row: Mapping[str, Any]) -> None:
        self.done += 1
        left = f", {duration(self.left_s)} left" if self.done < self.total else ""
        line = f"{self.name} {self.done}/{self.total}{left}  {outcome(row)}"
        failed = row["status"] in ("wrong", "crashed", "timeout", "out_of_memory", "overflow")
        if self._live is None:
            print(line, file=sys.stderr, flush=True)
        else:
            from rich.text import Text

            self._live.update(Text(line, overflow="ellipsis", no_wrap=True))
            if failed:
                self._live.console.print(Text(line))

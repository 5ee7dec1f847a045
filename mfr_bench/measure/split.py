"""Splits the wall time of a run, by kind of work."""

from __future__ import annotations

import time
from contextlib import contextmanager


class Split:
    """Seconds by kind; nested work counts for the inner kind alone."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._stack: list[str] = []
        self._since = time.perf_counter()

    def _settle(self) -> None:
        now = time.perf_counter()
        if self._stack:
            kind = self._stack[-1]
            self.seconds[kind] = self.seconds.get(kind, 0.0) + now - self._since
        self._since = now

    @contextmanager
    def work(self, kind: str):
        self._settle()
        self._stack.append(kind)
        try:
            yield
        finally:
            self._settle()
            self._stack.pop()

    def rounded(self) -> dict[str, float]:
        return {kind: round(seconds, 3) for kind, seconds in self.seconds.items()}

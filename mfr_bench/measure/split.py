"""Splits the wall time of a run, by kind of work."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import contextmanager

# Kinds of work of the device; the rest is the host's.
FRAMES = ("first frames", "warm-up", "measure", "passes", "last frames", "counting frames", "reference")
OTHER = "other"  # what no kind counted


class Split:
    """Seconds by kind; nested work counts for the inner kind alone. clock: wall time unless another is given."""

    def __init__(self, clock: Callable[[], float] | None = None) -> None:
        self.seconds: dict[str, float] = {}
        self._stack: list[str] = []
        self._clock = clock or time.perf_counter
        self._since = self._clock()

    def _settle(self) -> None:
        now = self._clock()
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

    def move(self, seconds: float, of: str, to: str) -> None:
        """Count as another kind so much of what a kind has spent, or all of it if that is less."""
        moved = min(seconds, self.seconds.get(of, 0.0))
        if moved > 0:
            self.seconds[of] -= moved
            self.seconds[to] = self.seconds.get(to, 0.0) + moved

    def rounded(self) -> dict[str, float]:
        return {kind: round(seconds, 3) for kind, seconds in self.seconds.items()}

    def taken(self) -> dict[str, float]:
        """The seconds by kind since the last call."""
        self._settle()
        found, self.seconds = self.rounded(), {}
        return found

    def whole(self, wall_s: float) -> dict[str, float]:
        """The seconds by kind, and what is left of the wall time as OTHER, so that all add up to it."""
        found = self.rounded()
        return found | {OTHER: round(max(0.0, wall_s - sum(found.values())), 3)}


def busy_share(split_s: Mapping[str, float]) -> float:
    """The share of a run's wall time in which its device drew frames."""
    return sum(split_s.get(kind, 0.0) for kind in FRAMES) / (sum(split_s.values()) or 1.0)


def told(split_s: Mapping[str, float], most: int = 3) -> str:
    """One line: the share of the device's frames, and the kinds of the host's work that took longest."""
    wall_s, share = sum(split_s.values()), busy_share(split_s)
    longest = sorted(((spent_s, kind) for kind, spent_s in split_s.items() if kind not in FRAMES), reverse=True)[:most]
    rest = ", ".join(f"{kind} {100 * spent_s / wall_s:.0f} %" for spent_s, kind in longest if wall_s)
    return f"device busy with frames {100 * share:.0f} % of {wall_s:.3g} s; {rest}"

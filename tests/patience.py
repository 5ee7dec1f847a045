"""Waiting for other processes: far longer than they take, since a machine may be at work on ten other things."""

from __future__ import annotations

import time
from collections.abc import Callable

PATIENCE_S = 240.0  # until a process counts as one that hangs; only a test that fails waits so long
LOOK_S = 0.05


def until(true: Callable[[], object], what: str = "nothing happened in time") -> None:
    """Wait until something is true. Fail with `what`, which says what did not happen, where it is not in time."""
    ends = time.monotonic() + PATIENCE_S
    while not true():
        assert time.monotonic() < ends, what
        time.sleep(LOOK_S)

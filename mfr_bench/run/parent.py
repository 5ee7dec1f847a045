"""Ties a process to its parent: it ends with it, and leaves it to it what signals mean."""

from __future__ import annotations

import signal
from contextlib import suppress
from pathlib import Path

from ..orphans import die_with

# The parent decides what becomes of these. A scheduler sends one to every process of a job: a worker that ended of it
# before the parent had seen it would leave its cell as crashed.
ENDS_OF_A_RUN = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def live_for(parent: int) -> None:
    """Ignore what ends a run; the kernel kills this process once its parent dies, inside a call of the driver as well.

    Where memory runs out, this process goes before the parent, which keeps the rows.
    """
    for number in ENDS_OF_A_RUN:
        signal.signal(number, signal.SIG_IGN)
    die_with(parent)
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")

"""A process that measures nothing: frame times are numbers in order, so that a lost or doubled one shows."""

from __future__ import annotations

import os
import random
import sys
import time
from multiprocessing.connection import Connection

from mfr_bench.plan import Limits
from mfr_bench.run.events import Begun, Ended, Finished, Group, Ready, Sampled, Stop, Synced

DEVICE = {"renderer": "fake", "version": "1", "vendor": "", "slug": "fake", "kind": "cpu"}
BATCHES, BATCH = 10, 3  # of a cell
SLEEP_S = 0.002


def main() -> None:
    link = Connection(int(sys.argv[1]))
    try:
        link.send(Ready(DEVICE, Limits(frozenset(), 1 << 30, 1 << 14), "wall", {}))
        while True:
            request = link.recv()
            if isinstance(request, Group):
                link.send(Ended({}, measure(link, request)))
    except (EOFError, ConnectionError):
        os._exit(0)


def synced(link: Connection) -> bool:
    """Whether it should stop."""
    link.send(Synced())
    return isinstance(link.recv(), Stop)


def measure(link: Connection, group: Group) -> bool:
    taken = {job.key: len(group.partials[job.key].samples_ms) if job.key in group.partials else 0
             for job in group.jobs}
    while taken:
        for key in random.sample(list(taken), len(taken)):
            link.send(Begun(key, "sampling"))
            time.sleep(SLEEP_S)
            if taken[key] < BATCHES * BATCH:
                link.send(Sampled(key, tuple(map(float, range(taken[key], taken[key] + BATCH)))))
                taken[key] += BATCH
        if synced(link):
            return True
        for key in [key for key, count in taken.items() if count >= BATCHES * BATCH]:
            del taken[key]
            link.send(Finished(key, "ok", None, {"time_ms": 1.0, "timer": "wall", "samples": BATCHES * BATCH},
                               {"warmup_ms": [], "passes": {}, "buffers": {},
                                "samples_ms": list(map(float, range(BATCHES * BATCH)))}))
            synced(link)
    return False

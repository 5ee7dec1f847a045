"""Spreads work on many folders over processes, as many as there are cores."""

from __future__ import annotations

import gc
import importlib
import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import TypeVar

from .environment import usable_cores
from .errors import MfrError

GL = {"moderngl", "glcontext"}  # modules of a process that may hold a context
THREADED = {"flip_evaluator"}  # modules that may wait in a copy for threads which it has not (OpenBLAS ends its own)
FEWEST = 3  # items for which a process that is no copy is worth its start

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")


def in_processes(work: Callable[[Item], Outcome], items: Sequence[Item], processes: int | None = None,
                 imports: Sequence[str] = ()) -> Iterator[Outcome]:
    """The outcome of each item in turn, by other processes; in this one where a process would have too few items.

    What an item raises is raised here, and MfrError where a process was killed. The processes are copies of this one
    where it has nothing that a copy must not share, and else of one that has imported the modules `imports`, once for
    all. `work`, its items and outcomes pickle.
    """
    copies = _copies()
    count = min(processes or usable_cores() or 1, len(items) // (1 if copies else FEWEST))
    if count < 2:
        yield from map(work, items)
        return
    context = multiprocessing.get_context("fork" if copies else "forkserver")
    if copies:
        with uncollected():
            for name in imports:
                importlib.import_module(name)
    else:
        context.set_forkserver_preload(list(imports))
    # Not a Pool, which ends its processes by SIGTERM: a copy has this process's handler of it, which may go on.
    with ProcessPoolExecutor(count, context, _begin) as pool:
        try:
            yield from pool.map(work, items)
        except BrokenProcessPool:
            raise MfrError("a process ended before its work was done; for lack of memory?") from None


@contextmanager
def uncollected() -> Iterator[None]:
    """Suspend garbage collection, which looks at all that is made again and again."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def _copies() -> bool:
    """Whether a copy of this process is sound: it has no thread that a copy would wait for, and no GL context."""
    return threading.active_count() == 1 and not (GL | THREADED).intersection(sys.modules)


def _begin() -> None:
    """Let a process of the pool end with the one that wants its outcomes, and when that says so.

    A copy has that process's handlers of signals, which may go on; Ctrl-C reaches both, and the other one tells it.
    What it was given is never collected.
    """
    signal.set_wakeup_fd(-1)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    gc.freeze()
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    multiprocessing.parent_process().join()
    os._exit(1)

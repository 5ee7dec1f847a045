"""Spreads work on many folders over processes, as many as there are cores."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from threading import Thread
from typing import TypeVar

from .environment import usable_cores

FEWEST = 3  # items for which a process is worth its start

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")


def in_processes(work: Callable[[Item], Outcome], items: Sequence[Item], processes: int | None = None,
                 imports: Sequence[str] = ()) -> Iterator[Outcome]:
    """The outcome of each item in turn, by other processes; in this one where a process would have too few items.

    What an item raises is raised here. The processes are no copies of this one, which may hold a GL context, but of one
    that has imported the modules `imports`, once for all. `work`, its items and outcomes pickle.
    """
    count = min(processes or usable_cores() or 1, len(items) // FEWEST)
    if count < 2:
        yield from map(work, items)
        return
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(imports))
    with context.Pool(count, _watch_parent) as pool:
        yield from pool.imap(work, items)


def _watch_parent() -> None:
    """Let a process of the pool end with the one that wants its outcomes, whose child it is not."""
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    multiprocessing.parent_process().join()
    os._exit(1)

"""Spreads work on many folders over processes, as many as there are cores."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from .environment import usable_cores

Item = TypeVar("Item")
Outcome = TypeVar("Outcome")


def in_processes(work: Callable[[Item], Outcome], items: Sequence[Item],
                 processes: int | None = None) -> Iterator[Outcome]:
    """The outcome of each item in turn, by forked processes; in this one where one core or one item is all there is.

    What an item raises is raised here. Not where the process holds a GL context.
    """
    count = min(processes or usable_cores() or 1, len(items))
    if count < 2:
        yield from map(work, items)
        return
    with multiprocessing.get_context("fork").Pool(count) as pool:
        yield from pool.imap(work, items)

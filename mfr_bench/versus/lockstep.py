"""Rounds of pairs: for each cell a batch of frames of one tree, then of the other, both processes up at once.

What slows the machine down hits both batches of a pair, and their ratio is free of it. The places of buffers and code
in memory are drawn anew with every process, so that each round starts two new ones. A driver that draws on the CPU is
timed by the processor time that its process takes, which a load of other processes does not lengthen.
"""

from __future__ import annotations

import json
import math
import random
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field
from statistics import median
from typing import Any

from ..errors import DeviceError, UsageError
from ..stats import goals, median_interval
from .link import OPENING_S, Link, SideError
from .tree import Tree

BATCH_MS = 2.0  # of one batch, about: long against the clock's tick, short against a scheduler's slice
MOST_FRAMES = 200  # in a batch
PRECISE = 0.004  # half-width of a cell's ratio within a round, at which more pairs would change nothing
LEAST_PAIRS, MOST_PAIRS = 4, 300  # of a visit
VISITS = 6  # to each cell in a round: a load that lasts some seconds is in one of them
CELL_S = 120.0  # for one cell to be prepared, or to draw a batch
WARM_UP = 2  # batches of one frame

Identity = str


@dataclass(frozen=True)
class Ask:
    """The task that both sides are asked to measure. `seconds`: of a cell in a round, about."""

    config: str
    profile: str | None = None
    only: tuple[str, ...] | None = None
    overrides: tuple[str, ...] = ()
    device: str = "auto"
    rounds: int = 6
    seconds: float = 1.0


@dataclass
class Half:
    """A cell of one tree: what it is, its row, and its times in ms: of each round, of each visit in it."""

    told: Mapping[str, Any]
    status: str = "ok"
    reason: str | None = None
    values: Mapping[str, Any] = field(default_factory=dict)
    rounds_ms: list[list[list[float]]] = field(default_factory=list)


@dataclass
class Measured:
    """All cells of both trees, and the device and timer of both."""

    halves: tuple[dict[Identity, Half], dict[Identity, Half]]
    device: Mapping[str, Any]
    timer: str
    title: str


def identity(told: Mapping[str, Any]) -> Identity:
    """Equal for the cells of two trees that show one thing."""
    return json.dumps([told["method"], told["label"], told["point"]], sort_keys=True)


def measure(trees: tuple[Tree, Tree], ask: Ask, progress: Callable[[int, int], None] = lambda done, of: None,
            seed: int = 0, asked: Callable[[], bool] = lambda: False) -> Measured:
    """Measure every cell that both trees have. Raises UsageError and DeviceError where a tree cannot begin.

    Raises KeyboardInterrupt once `asked` is true; both processes have ended then.
    """
    found: Measured | None = None
    shuffle = random.Random(seed)  # noqa: S311 - an order, not a secret
    for number in range(ask.rounds):
        with ExitStack() as stack:
            links = tuple(stack.enter_context(closing(Link(tree, asked))) for tree in trees)
            opened = _opened(links, ask)
            found = found or _start(opened)
            _round(links, opened, found, ask, number, shuffle, progress, asked)
    return found


def _opened(links: Sequence[Link], ask: Ask) -> list[Mapping[str, Any]]:
    answers: list[Mapping[str, Any]] = []
    for link in links:
        try:
            answers.append(link.ask("open", OPENING_S, config=ask.config, profile=ask.profile, only=ask.only,
                                    overrides=ask.overrides, device=ask.device,
                                    timer=answers[0]["timer"] if answers else None))
        except SideError as error:
            kind = DeviceError if error.dead else UsageError
            raise kind(f"versus: {link.tree.name}: {error}") from None
    return answers


def _start(opened: Sequence[Mapping[str, Any]]) -> Measured:
    halves = tuple({identity(told): Half(told) for told in answer["cells"]} for answer in opened)
    return Measured(halves, opened[1]["device"], opened[1]["timer"], opened[1]["title"])


def _round(links: Sequence[Link], opened: Sequence[Mapping[str, Any]], found: Measured, ask: Ask, number: int,
           shuffle: random.Random, progress: Callable[[int, int], None], asked: Callable[[], bool]) -> None:
    """Visit each shared cell VISITS times; one that fails on a side stays out from then on."""
    places = [{identity(told): at for at, told in enumerate(answer["cells"])} for answer in opened]
    shared = [key for key in places[0] if key in places[1]]
    for key in shared:
        for side in found.halves:
            side[key].rounds_ms.append([])
    cpus = sorted(set(opened[0]["cpus"]).intersection(opened[1]["cpus"]))
    for visit in range(VISITS):
        for key in shared:
            if asked():
                raise KeyboardInterrupt
            halves = tuple(side[key] for side in found.halves)
            if all(half.status == "ok" for half in halves):
                _stay(links, halves, shuffle.choice(cpus) if cpus else None)
                _cell(links, [place[key] for place in places], halves, ask, shuffle, check=not number and not visit)
        progress(number * VISITS + visit + 1, ask.rounds * VISITS)


def _stay(links: Sequence[Link], halves: Sequence[Half], cpu: int | None) -> None:
    """Bring both processes to one processor: two of them may be unequal for as long as a round takes."""
    for link, half in zip(links, halves, strict=True):
        if cpu is not None:
            _asked(link, half, "stay", cpu=cpu)


def _cell(links: Sequence[Link], at: Sequence[int], halves: Sequence[Half], ask: Ask, shuffle: random.Random,
          check: bool) -> None:
    """Visit a cell: prepare it on both sides, draw its pairs. The side that comes first is drawn anew each time."""
    order = shuffle.sample((0, 1), 2)
    for side in order:
        half = halves[side]
        answer = _asked(links[side], half, "prepare", cell=at[side], check=check)
        if answer:
            half.status, half.reason, half.values = answer["status"], answer["reason"], answer["values"]
    if all(half.status == "ok" for half in halves):
        _pairs(links, halves, ask, order)
    for link, half in zip(links, halves, strict=True):
        _asked(link, half, "release")


def _asked(link: Link, half: Half, do: str, **more: Any) -> Mapping[str, Any] | None:
    """The answer; None where the side failed, which is the cell's status from then on.

    Raises DeviceError where the process of the side is gone: its other cells cannot be measured in this round.
    """
    try:
        return link.ask(do, CELL_S, **more)
    except SideError as error:
        half.status, half.reason = "crashed", str(error)
        if error.dead:
            raise DeviceError(f"versus: {link.tree.name}: {half.told['label']}: {error}") from None
        return None


def _pairs(links: Sequence[Link], halves: Sequence[Half], ask: Ask, order: list[int]) -> None:
    """Draw batches in pairs until the ratio is precise or the time is up.

    Either tree comes first in turns, A B B A: what the first of two loses to the second hits both alike. order: the
    side that begins, and the other.
    """
    order = list(order)
    frames = _frames(links, halves, order)
    if not frames:
        return
    times: tuple[list[float], list[float]] = ([], [])
    for half, mine in zip(halves, times, strict=True):
        half.rounds_ms[-1].append(mine)
    until = time.monotonic() + ask.seconds / VISITS
    looks = set(goals(LEAST_PAIRS, MOST_PAIRS))
    while True:
        pair: list[float | None] = [None, None]
        for side in order:
            answer = _asked(links[side], halves[side], "batch", frames=frames)
            pair[side] = answer and answer["ms"]
        if None in pair:
            return
        order.reverse()
        for mine, ms in zip(times, pair, strict=True):
            mine.append(ms)
        count = len(times[0])
        if count >= MOST_PAIRS or (count >= LEAST_PAIRS and time.monotonic() > until):
            return
        if count in looks and precise(log_ratios(*times)):
            return


def log_ratios(before_ms: Sequence[float], after_ms: Sequence[float]) -> list[float]:
    """The logarithms of the ratios of all pairs that have times."""
    return [math.log(a / b) for b, a in zip(before_ms, after_ms, strict=True) if a > 0 and b > 0]


def precise(ratios: Sequence[float]) -> bool:
    low, _, high = median_interval(ratios)
    return low is not None and high is not None and (high - low) / 2 <= PRECISE


def _frames(links: Sequence[Link], halves: Sequence[Half], order: Sequence[int]) -> int:
    """Frames in a batch; 0 where a side fails.

    The side that comes first in the pairs is warmed up first as well: if it were the last to draw before them, its
    caches would be warm.
    """
    times: list[list[float]] = [[], []]
    for side in WARM_UP * list(order):
        answer = _asked(links[side], halves[side], "batch", frames=1)
        if answer is None:
            return 0
        times[side].append(answer["ms"])
    longest = max(median(map(min, times)), 1e-3)
    return max(1, min(MOST_FRAMES, round(BATCH_MS / longest)))

"""Shares of a run for several machines: whole scenes, so that what a figure compares is measured in turns on one.

A scene that a forecast gives longer than a task may take is split by methods: those of a group still draw in turns.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from ..config.model import Experiment
from ..scene import Scene
from .cells import Cell
from .expected import expected_stats
from .forecast import Forecast, Rates, frames_s, rough_duration

MOST_SHARES = 10_000
Plans = list[tuple[Experiment, list[Cell]]]
Unit = tuple[Scene, int]  # a scene, and the number of its group of methods


@dataclass(frozen=True)
class SplitScene:
    """A scene whose methods are measured in several tasks: the forecast of the whole, and the labels of each group."""

    scene: Scene
    seconds: float
    groups: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Units:
    """The parts of a run that one task measures whole: a scene, or a group of its methods where it takes too long.

    seconds: the forecast of each. group: by identity of a cell, its group, of cells that are in another than the first.
    splits: the scenes that are split.
    """

    seconds: Mapping[Unit, float]
    group: Mapping[tuple, int]
    splits: Sequence[SplitScene]

    def of(self, cell: Cell) -> Unit:
        """The unit that a cell belongs to."""
        return cell.scene, self.group.get(_identity(cell), 0)


def units_of(plans: Plans, most_s: float | None = None) -> Units:
    """The units of a run, by a forecast that knows no device: every machine finds the same.

    most_s: seconds from which a scene is split by methods; None splits none.
    """
    forecast = Forecast((), Rates())
    scenes: dict[Scene, dict[tuple, tuple[Cell, float]]] = {}
    for _, cells in plans:
        for cell in cells:
            scene = scenes.setdefault(cell.scene, {})
            before = scene.get(_identity(cell), (cell, 0.0))[1]
            scene[_identity(cell)] = cell, before + cell_s(forecast, cell)
    seconds: dict[Unit, float] = {}
    group: dict[tuple, int] = {}
    splits = []
    for scene, found in scenes.items():
        total = sum(spent for _, spent in found.values())
        groups = [found] if most_s is None or total <= most_s else _grouped(found, most_s)
        for number, members in enumerate(groups):
            seconds[scene, number] = sum(spent for _, spent in members.values())
            group |= dict.fromkeys(members, number) if number else {}
        if len(groups) > 1:
            labels = [list(dict.fromkeys(cell.label for cell, _ in members.values())) for members in groups]
            splits.append(SplitScene(scene, total, labels))
    return Units(seconds, group, splits)


def _grouped(found: Mapping[tuple, tuple[Cell, float]], most_s: float) -> list[dict[tuple, tuple[Cell, float]]]:
    """The cells of a scene in groups of at most so many seconds: as few as that takes, alike in length.

    The cells of a method stay together unless they alone take longer; methods stay in the order of the config.
    """
    methods: dict[str, dict[tuple, tuple[Cell, float]]] = {}
    for identity, (cell, spent) in found.items():
        methods.setdefault(cell.method, {})[identity] = cell, spent
    pieces = [piece for members in methods.values() for piece in (
        [members] if _sum(members) <= most_s else [{identity: each} for identity, each in members.items()])]
    aim_s = _sum(found) / math.ceil(_sum(found) / most_s)
    groups: list[dict[tuple, tuple[Cell, float]]] = [{}]
    for piece in pieces:
        here = _sum(groups[-1])
        full = here + _sum(piece) > most_s or here + _sum(piece) / 2 > aim_s
        if groups[-1] and full:
            groups.append({})
        groups[-1] |= piece
    return groups


def _sum(members: Mapping[tuple, tuple[Cell, float]]) -> float:
    return sum(spent for _, spent in members.values())


def _identity(cell: Cell) -> tuple:
    """Equal for cells that are one measurement, in whichever experiments."""
    return cell.method, tuple(sorted(cell.params.items())), cell.scene, cell.measure


def shards(plans: Plans, units: Units, count: int) -> list[Plans]:
    """All shares of a run: each unit of all experiments falls to one share, whatever the device is.

    Units go to the share that has least to do, the longest first: every machine that is asked finds the same shares.
    An experiment without cells in a share stays in it, empty.
    """
    share = {unit: number for number, mine in enumerate(_shares(units.seconds, count)) for unit in mine}
    found: list[Plans] = [[(experiment, []) for experiment, _ in plans] for _ in range(count)]
    for i, (_, cells) in enumerate(plans):
        for cell in cells:
            found[share[units.of(cell)]][i][1].append(cell)
    return found


def cell_s(forecast: Forecast, cell: Cell) -> float:
    """Seconds that a forecast gives a cell, with what surrounds its frames."""
    stats = expected_stats(cell.scene)
    return frames_s(forecast.frame(cell, stats), cell.measure) + forecast.rates.around_s(stats)


def _shares(seconds: Mapping[Unit, float], count: int) -> Sequence[set[Unit]]:
    shares: list[set[Unit]] = [set() for _ in range(count)]
    loads = [0.0] * count
    for unit, spent in sorted(seconds.items(), key=lambda item: -item[1]):  # equal ones in the order of the plans
        least = loads.index(min(loads))
        shares[least].add(unit)
        loads[least] += spent
    return shares


def split_lines(splits: Iterable[SplitScene]) -> list[str]:
    """A line for each scene that is split, as a plan says it."""
    return [f"{_named(split.scene)}: by forecast {rough_duration(split.seconds)}, split into {len(split.groups)} "
            "groups of methods: " + " | ".join(", ".join(labels) for labels in split.groups) for split in splits]


def _named(scene: Scene) -> str:
    width, height = scene.size
    return f"scene of {width}x{height} pixels, n = {expected_stats(scene).n}"

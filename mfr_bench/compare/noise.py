"""Estimates how far two runs of the same thing are apart: more than the intervals within each suggest.

A run's clock, its load and the places of its buffers in memory are drawn anew with each run, and no number of frames
within one run averages over them. What is common to all methods of a scene is taken out; what is left between the
cells, robustly, is how far apart two runs of one thing are. A few cells that did change do not move it.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Hashable, Iterable, Sequence, Sized
from dataclasses import dataclass
from statistics import NormalDist, fmean, median

COMMON_LEAST = 5  # methods in a scene, from which on what they have in common differs from what one of them did
SPREAD_LEAST = 20  # cells, from which on they show their own spread, and noise floors say nothing more
LEAST = 1e-6  # deviation: no clock tells times apart to one in a million
HALF_NORMAL = 0.6745  # median of the absolute value of a normal variable
OUTER = 3.0  # deviations, from which on a cell tells nothing of how far the others are apart
INNER_VARIANCE = 0.9733  # of the normal variables within so many deviations
MOST_STRETCH = 4.0  # Cauchy's own: cells that many deviations out have changed, and do not hide one another
TAILS = ((0.8, 1.0), (0.9, 1.0), (0.95, 0.9))  # quantile of the distances, and its weight: the last is of few cells


@dataclass(frozen=True)
class Shift:
    """The change of one cell: logarithm of the ratio of its times, and the standard error of that within the runs.

    `burst`: logarithm of how many times as long the slowest frames, or turns, of such a time are. `steady`: whether the
    device was as fast as ever while the cell was sampled, on both sides; None where nothing tells.
    """

    scene: Hashable
    method: Hashable
    log_ratio: float
    error: float
    burst: float = 0.0
    steady: bool | None = None


@dataclass(frozen=True)
class Noise:
    """`common`: logarithm that each cell's scene has in common. `deviations`: of each cell between runs, logarithms.

    `between`: the part of the deviations that is not within the runs. `spread`: the whole of it, as far apart as the
    cells are. `stretch`: how much longer the tails are than a normal distribution's, from 1 to MOST_STRETCH.
    """

    common: tuple[float, ...]
    deviations: tuple[float, ...]
    between: float
    spread: float
    stretch: float
    floor: float  # relative; no smaller change counts. 0 where the cells show how far they are apart


def estimate(shifts: Sequence[Shift], floor: float, alike: bool = True) -> Noise:
    """The noise between two runs. `floor`: how far a run's own A/A pair was apart, relative.

    Runs that are not `alike`, of two devices, tell nothing of it: each cell is then as far apart as its pair.
    """
    if not alike:
        return Noise((0.0,) * len(shifts), tuple(max(LEAST, math.hypot(s.error, floor)) for s in shifts), floor,
                     floor, 1.0, floor)
    telling = _telling(shifts)
    common = _common(shifts, telling)
    rest = [s.log_ratio - c for s, c in zip(shifts, common, strict=True)
            if telling is shifts or s.steady is not False]
    errors = [s.error for s in telling]
    between = _between(rest, errors, floor)
    deviations = tuple(max(LEAST, math.hypot(s.error, between)) for s in shifts)
    distances = sorted(abs(r) / max(LEAST, math.hypot(e, between)) for r, e in zip(rest, errors, strict=True))
    spread = max(LEAST, _between(rest, [0.0] * len(rest), floor))
    stretch, least = (_stretch(distances), 0.0) if _show_spread(distances) else (1.0, floor)
    return Noise(common, deviations, max(LEAST, between), spread, stretch, least)


def _show_spread(cells: Sized) -> bool:
    """Whether cells are enough to show how far two runs are apart."""
    return len(cells) >= SPREAD_LEAST


def _telling(shifts: Sequence[Shift]) -> Sequence[Shift]:
    """The cells that tell how far two runs are apart: those that nothing is known to have slowed, where enough are."""
    found = [shift for shift in shifts if shift.steady is not False]
    return found if _show_spread(found) else shifts


def _common(shifts: Sequence[Shift], telling: Sequence[Shift]) -> tuple[float, ...]:
    """The change common to each cell's scene: the median over methods of their medians; 0 where methods are few."""
    scenes: dict[Hashable, dict[Hashable, list[float]]] = defaultdict(lambda: defaultdict(list))
    for shift in telling:
        scenes[shift.scene][shift.method].append(shift.log_ratio)
    everywhere: dict[Hashable, list[float]] = defaultdict(list)
    for shift in telling:
        everywhere[shift.method].append(shift.log_ratio)
    of_all = _median_of(everywhere, 0.0)
    of_scene = {scene: _median_of(methods, of_all) for scene, methods in scenes.items()}
    return tuple(of_scene.get(shift.scene, of_all) for shift in shifts)


def _median_of(methods: dict[Hashable, list[float]], otherwise: float) -> float:
    return median(map(median, methods.values())) if len(methods) >= COMMON_LEAST else otherwise


def _between(rest: Sequence[float], errors: Sequence[float], floor: float) -> float:
    """The deviation between runs, beyond that within them, as the cells show it; the noise floor where they are few.

    A noise floor is one cell's, within one run, and the end of an interval: a few stalled frames make it ten times what
    all the other cells show. So it counts for nothing beside them.
    """
    if not _show_spread(rest):
        return floor
    cells = list(zip(rest, errors, strict=True))
    coarse = _solved(lambda scale: median(_distances(cells, scale)) > HALF_NORMAL)
    inner = [cell for cell, distance in zip(cells, _distances(cells, coarse), strict=True) if distance < OUTER]
    return _solved(lambda scale: fmean(d**2 for d in _distances(inner, scale)) > INNER_VARIANCE)


def _distances(cells: Iterable[tuple[float, float]], between: float) -> list[float]:
    """The distances of cells, each with its error, in deviations."""
    return [abs(r) / (math.hypot(error, between) or math.inf) for r, error in cells]


def _solved(too_small: Callable[[float], bool]) -> float:
    """The least deviation of which this is not true."""
    low, high = 0.0, 10.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if too_small(middle) else (low, middle)
    return high


def _stretch(distances: Sequence[float]) -> float:
    """The distance of the outer cells, over that where a normal distribution has them; what is more is no noise."""
    normal = NormalDist()
    found = (weight * distances[math.ceil(share * len(distances)) - 1] / normal.inv_cdf((1 + share) / 2)
             for share, weight in TAILS)
    return min(MOST_STRETCH, max(1.0, *found))

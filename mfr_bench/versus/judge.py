"""The verdict on each cell of two trees, by the rules of `compare`, from pairs that were measured in turns.

A pair's ratio is free of the load and the clock, so nothing is taken out as common, and no cell needs the support of
another. What is left between the rounds, each with processes of its own, is how far two runs of one thing are apart.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import NormalDist, fmean, median, stdev
from typing import Any

import numpy as np

from ..compare.judge import (
    FASTER,
    SAME,
    SAME_RATE,
    SLOWER,
    UNCLEAR,
    CellVerdict,
    Change,
    Comparison,
    Judged,
    Together,
    compared,
)
from ..compare.noise import HALF_NORMAL
from ..compare.sides import Side, load_side
from ..stats import sampled_interval
from ..store import ResultFolder, key
from ..store.rows import derive
from .lockstep import Half, Measured, log_ratios

ERROR_RATE = 0.01  # of a whole comparison: the chance of any false alarm, were the noise as it is estimated
CENTRE_EFFICIENCY = 1.0233  # standard error of `centre` over that of a mean, of normal samples
LEAST = 5e-4  # deviation of a cell's ratio, logarithm: no two processes are more alike


@dataclass(frozen=True)
class Ratio:
    """The logarithm of a cell's ratio, after / before: of each round, and its standard error within the rounds.

    cells: how many of them it is the mean of.
    """

    rounds: tuple[float, ...]
    within: float
    cells: int = 1

    @property
    def moved(self) -> float:
        return fmean(self.rounds)


def ratio_of(before: Half, after: Half) -> Ratio | None:
    """The ratio of a cell that has pairs in some round: of each the centre of the pairs of all its visits."""
    rounds = [[found for b, a in zip(before_ms, after_ms, strict=True) for found in log_ratios(b, a)]
              for before_ms, after_ms in zip(before.rounds_ms, after.rounds_ms, strict=True)]
    rounds = [ratios for ratios in rounds if ratios]
    if not rounds:
        return None
    return Ratio(tuple(map(centre, rounds)), math.sqrt(sum(_error(ratios)**2 for ratios in rounds)) / len(rounds))


def centre(ratios: Sequence[float]) -> float:
    """The median of the means of all two of them (Hodges & Lehmann 1963).

    As robust against a few that are far out as a median needs to be here, and nearly as precise as a mean.
    """
    values = np.asarray(ratios)
    return float(np.median((values[:, None] + values)[np.triu_indices(len(values))]) / 2)


def _error(ratios: Sequence[float]) -> float:
    """Standard error of the centre of a round's pairs."""
    middle = median(ratios)
    spread = median(abs(r - middle) for r in ratios) / HALF_NORMAL
    return CENTRE_EFFICIENCY * spread / math.sqrt(len(ratios) - 1) if len(ratios) > 1 else math.inf


def together(ratios: Sequence[Ratio]) -> Ratio | None:
    """The mean of several cells' ratios, round by round; None where fewer than two have all rounds."""
    most = max((len(r.rounds) for r in ratios), default=0)
    whole = [r for r in ratios if len(r.rounds) == most]
    if len(whole) < 2:
        return None
    within = math.sqrt(sum(r.within**2 for r in whole)) / len(whole)
    return Ratio(tuple(map(fmean, zip(*(r.rounds for r in whole), strict=True))), within, len(whole))


class Judge:
    """The verdicts on times, of all cells together: how far rounds of one cell are apart is pooled over them.

    That scatter has the noise within the rounds in it, so that the larger of both counts, not their sum. `groups`: how
    many sets of cells are judged besides, which share the error rate with them.
    """

    def __init__(self, ratios: Mapping[Any, Ratio], threshold: float, groups: int = 0):
        self._limit = math.log1p(threshold)
        self._critical = NormalDist().inv_cdf(1 - ERROR_RATE / 2 / max(1, len(ratios) + groups))
        self.between = between(list(ratios.values()))

    def decided(self, ratio: Ratio | None) -> Judged:
        """Verdict, reason, ratio with its interval, ratio as measured."""
        if ratio is None:
            return UNCLEAR, "a side has no sample of a time above 0", (None, None, None), None
        moved = ratio.moved
        deviation = max(LEAST, ratio.within, self.between / math.sqrt(len(ratio.rounds) * ratio.cells))
        if ratio.cells > 1 and len(ratio.rounds) > 1:  # what the cells of a round have in common
            deviation = max(deviation, stdev(ratio.rounds) / math.sqrt(len(ratio.rounds)))
        reach = self._critical * deviation
        interval = math.exp(moved - reach), math.exp(moved), math.exp(moved + reach)
        return *self._verdict(ratio, deviation, reach), interval, math.exp(moved)

    def _verdict(self, ratio: Ratio, deviation: float, reach: float) -> tuple[str, str]:
        moved = ratio.moved
        alike = all(r * moved > 0 and abs(r) > self._limit / 2 for r in ratio.rounds)
        if abs(moved) > self._limit and abs(moved) > reach:
            return (SLOWER if moved > 0 else FASTER, "") if alike else (UNCLEAR, "the rounds differ: more of them tell")
        if abs(moved) + NormalDist().inv_cdf(1 - SAME_RATE) * deviation < self._limit:
            return SAME, ""
        return UNCLEAR, "no more than what two runs of one thing differ by here"


def between(ratios: Sequence[Ratio]) -> float:
    """The deviation of a cell's ratio between rounds, pooled over the cells; a few that are far out move it little."""
    apart = [abs(r - found.moved) * math.sqrt(len(found.rounds) / (len(found.rounds) - 1))
             for found in ratios if len(found.rounds) > 1 for r in found.rounds]
    return median(apart) / HALF_NORMAL if apart else 0.0


def judged(measured: Measured, names: tuple[str, str], folder: Path, threshold: float) -> Comparison:
    """Write both sides as results into `folder`/before and `folder`/after, and compare them."""
    before, after = measured.halves
    ratios = {mine: found for mine, half in after.items()
              if mine in before and (found := ratio_of(before[mine], half)) is not None}
    groups = _all_cells(ratios)
    judge = Judge(ratios, threshold, len(groups))
    sides = [_written(measured, half, folder / which, name, judge.between)
             for half, which, name in zip(measured.halves, ("before", "after"), names, strict=True)]
    by_key = {_key(mine, half): mine for mine, half in after.items()}
    found = compared(*sides, threshold, math.expm1(judge.between), True,
                     lambda _, entry: judge.decided(ratios.get(by_key[entry.point.cell["key"]])))
    return replace(found, verdicts=tuple(map(_with_settings, found.verdicts)),
                   together=tuple(Together(name, *judge.decided(ratio)[:3]) for name, ratio in groups.items()))


def _all_cells(ratios: Mapping[str, Ratio]) -> dict[str, Ratio]:
    """What all cells have in common: a change of several shows where that of none does."""
    found = together(list(ratios.values()))
    return {"all cells": found} if found else {}


def _with_settings(verdict: CellVerdict) -> CellVerdict:
    """The verdict with the parameters that are others in the second tree: a default that was changed, for instance."""
    was, now = verdict.before.point.cell["params"], verdict.after.point.cell["params"]
    told = [f"{name} {was.get(name, 'none')} -> {now.get(name, 'none')}" for name in dict.fromkeys([*was, *now])
            if was.get(name) != now.get(name)]
    return replace(verdict, changes=(*verdict.changes, *(Change(text, None) for text in told)))


def _key(mine: str, half: Half) -> str:
    return key({"identity": mine, "scene": half.told["scene"], "params": half.told["params"]})


def _written(measured: Measured, halves: Mapping[str, Half], path: Path, name: str, noise: float) -> Side:
    """The cells of a side as a result folder, read back, by what the config says of them. Raises StoreError."""
    folder = ResultFolder(path)
    cells = [_record(measured, mine, half) for mine, half in halves.items()]
    folder.write_manifest({
        "name": next((c["experiment"] for c in cells), name), "title": measured.title, "device": dict(measured.device),
        "timer": measured.timer, "noise_floor_rel": math.expm1(noise), "cells": [c["key"] for c in cells]})
    for cell in cells:
        folder.write_cell(cell)
    derive(folder)
    side = load_side(str(path))
    by_key = {_key(mine, half): mine for mine, half in halves.items()}
    return replace(side, path=name, entries={by_key[e.point.cell["key"]]: e for e in side.entries.values()})


def _record(measured: Measured, mine: str, half: Half) -> dict[str, Any]:
    """A half of a cell as a result folder holds it."""
    samples = [ms for visits in half.rounds_ms for times in visits for ms in times]
    low, middle, high = sampled_interval(samples) if samples else (None, None, None)
    timed = {"samples": len(samples), "time_ms": middle, "time_ms_low": low, "time_ms_high": high} if samples else {}
    return {**half.told, "key": _key(mine, half), "status": half.status, "reason": half.reason,
            "values": {**half.values, **timed}, "samples_ms": samples,
            "pairs": [list(map(len, visits)) for visits in half.rounds_ms],
            "device": {part: measured.device.get(part) for part in ("slug", "renderer", "version")}}

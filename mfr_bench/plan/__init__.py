"""Experiments -> cells in the order that shares most work, and what a device or a budget forbids. Pure."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import accumulate, pairwise
from typing import Any, Literal

from ..config.axes import measure_at, points, scene_at
from ..config.layout import (
    block,
    covered_pixels,
    has_mean_depth,
    is_flat,
    least_layers,
    mean_depth,
    quad_count,
    quad_size,
    shares,
)
from ..config.model import Experiment, Measure, MethodEntry, Scene
from ..environment import MIB
from ..errors import UsageError, nearest
from ..methods import FLOOR
from ..methods.spec import SCENE_FACTS, Fitted, Method, SceneStats, Value

Decision = tuple[Literal["unsupported", "over_budget"], str]


@dataclass(frozen=True)
class Cell:
    """One point to measure: a method, all its parameters, a scene. `point` is where the axes that matter to it are.

    `k_saves_passes`: more k is not more work, for the geometry is drawn less often.
    """

    experiment: str
    method: str
    label: str
    params: Mapping[str, Value]
    scene: Scene
    measure: Measure
    point: Mapping[str, Any]
    k_saves_passes: bool = False

    @property
    def identity(self) -> tuple:
        """Equal for cells that show the same number in the same series."""
        return self.method, self.label, tuple(sorted(self.params.items())), self.scene, self.measure


@dataclass(frozen=True)
class Limits:
    """What a device allows."""

    features: frozenset[str]
    max_block_bytes: int  # largest shader storage block
    max_texture_size: int  # pixels, either side
    max_local_array: int | None = None  # fragments in a shader's local array, where more would compile for minutes
    failed_trials: Mapping[str, str] = field(default_factory=dict)  # of a feature that the driver claims and gets wrong

    def lacks(self, feature: str) -> str:
        """The feature, with the trial that it fails where the driver claims it."""
        return f"{feature}, which fails {self.failed_trials[feature]}" if feature in self.failed_trials else feature


def expand(experiment: Experiment, catalog: Mapping[str, Method], only: Sequence[str] | None = None) -> list[Cell]:
    """The cells of an experiment: those of a scene together, scenes in the order of the sweep.

    Cells that would be measured alike appear once. The floor is measured for every scene that has another
    cell. `only` keeps the methods of these ids. Raises UsageError for an id that is not in the catalog.
    """
    entries = _chosen(experiment.methods, catalog, only)
    by_scene: dict[Scene, dict[tuple, Cell]] = defaultdict(dict)
    for point in points(experiment.sweep, experiment.zip) if entries else ():
        for entry in entries:
            cell = _cell(experiment, catalog[entry.id], entry, point)
            by_scene[cell.scene].setdefault(cell.identity, cell)
    return [cell for cells in by_scene.values() for cell in cells.values()]


def _chosen(entries: Sequence[MethodEntry], catalog: Mapping[str, Method],
            only: Sequence[str] | None) -> list[MethodEntry]:
    """The entries to measure, the floor first where it is not listed."""
    unknown = [i for i in only or () if i not in catalog]
    if unknown:
        raise UsageError(f"--only: unknown method {i!r}; allowed: {', '.join(catalog)}{nearest(i, catalog)}"
                         for i in unknown)
    chosen = [e for e in entries if only is None or e.id in only]
    wanted = chosen or FLOOR in (only or ())
    if not wanted or FLOOR not in catalog or any(e.id == FLOOR for e in chosen):
        return chosen
    listed = [e for e in entries if e.id == FLOOR]
    return [*(listed or [MethodEntry(FLOOR, catalog[FLOOR].name, {})]), *chosen]


def _cell(experiment: Experiment, method: Method, entry: MethodEntry, point: Mapping[str, Any]) -> Cell:
    params = method.complete({**experiment.params, **point, **entry.params})
    with_r = "r" in experiment.params or "r" in point
    mine = {key: value for key, value in point.items()
            if "." in key or (key in params and key not in entry.params) or (with_r and key in ("r", "k"))}
    return Cell(experiment.name, entry.id, entry.label, params, scene_at(experiment.scene, experiment.params, point),
                measure_at(experiment.measure, point), mine, method.k_saves_passes)


def judge(cell: Cell, catalog: Mapping[str, Method], stats: SceneStats, limits: Limits | None) -> Decision | None:
    """Why a cell is not measured, or None. Without limits only the budget is held against it."""
    variant = catalog[cell.method].variant(cell.params)
    fitted = Fitted(variant, stats)
    missing = [limits.lacks(f) for f in variant.needs if limits and f not in limits.features]
    missing += [SCENE_FACTS[f] for f in variant.asks if not getattr(stats, f)]
    if missing:
        return "unsupported", f"needs {', '.join(missing)}"
    deepest = variant.method.deepest
    if deepest and stats.n > deepest:
        return "over_budget", f"a pixel has {stats.n} fragments, the method has room for {deepest}"
    local = fitted.local_array()
    if limits and limits.max_local_array and local > limits.max_local_array:
        return "over_budget", (f"needs a local array of {local} fragments in a shader, which this driver compiles for "
                               f"minutes; allowed: {limits.max_local_array}")
    side = max(stats.W, stats.H)
    if limits and side > limits.max_texture_size:
        return "over_budget", f"needs textures of {side} pixels a side, the device allows {limits.max_texture_size}"
    allowed, least = variant.budget_bytes, fitted.least_bytes()
    if least > allowed:
        return "over_budget", (f"needs at least {_mib(least)}, {variant.method.capacity.budget} allows it "
                               f"{_mib(allowed)}")
    memory = fitted.memory_bytes()
    for buffer in variant.buffers:
        if limits and memory[buffer.name] > limits.max_block_bytes:
            return "over_budget", (f"needs {_mib(memory[buffer.name])} for {buffer.name}, the device allows "
                                   f"{_mib(limits.max_block_bytes)} in a storage block")
    total, budget = sum(memory.values()), cell.measure.memory_budget_mb * MIB
    return ("over_budget", f"needs {_mib(total)}, the budget is {_mib(budget)}") if total > budget else None


@dataclass(frozen=True)
class Known:
    """How a cell has ended: its status and its median frame, where it has one."""

    cell: Cell
    status: str
    time_ms: float | None

    def over_limit(self, measure: Measure) -> bool:
        """Whether one frame already takes longer than all frames may by these settings."""
        if self.time_ms is not None:
            return self.time_ms / 1e3 > measure.time_limit_s
        return self.status == "timeout" and self.cell.measure.longest_s >= measure.longest_s

    def __str__(self) -> str:
        scene = self.cell.scene
        where = f"{scene.size[0]} x {scene.size[1]} pixels, n = {scene.depth_complexity}"
        where += f" (mean {mean_depth(scene):g})" if has_mean_depth(scene) else ""
        where += f", k = {self.cell.params['k']}" if "k" in self.cell.params else ""
        took = "timed out" if self.time_ms is None else f"took {self.time_ms / 1e3:.3g} s a frame"
        return f"{self.cell.label} at {where} {took}"


GROWING = ("pixel_density", "depth_complexity", "fragment_probability")  # more of it is more work


def hopeless(cell: Cell, known: Iterable[Known]) -> str | None:
    """Why a cell cannot be measured within its limits, by a smaller one that could not; None where none tells."""
    smaller = [k for k in known if k.over_limit(cell.measure) and _no_smaller(cell, k.cell)]
    found = min(smaller, key=lambda k: k.time_ms is None, default=None)
    return None if found is None else (f"{found}, where time_limit_s allows {cell.measure.time_limit_s:g} s for all "
                                       "frames; --try-hopeless measures it all the same")


def _no_smaller(cell: Cell, other: Cell) -> bool:
    """Whether a cell is another one with more of what makes work, and otherwise the same."""
    (kind, size), (other_kind, other_size) = _kind_and_size(cell), _kind_and_size(other)
    return kind == other_kind and all(a >= b for a, b in zip(size, other_size, strict=True))


def _kind_and_size(cell: Cell) -> tuple[tuple, tuple]:
    scene, params = cell.scene.as_dict(), dict(cell.params)
    scene["mean_depth"] = None
    mean = mean_depth(cell.scene) if has_mean_depth(cell.scene) else 0
    k = 0 if cell.k_saves_passes else params.pop("k", 0)
    size = (*scene.pop("size"), *(scene.pop(name) for name in GROWING), mean, k)
    return (cell.method, repr(sorted(params.items())), repr(sorted(scene.items()))), size


def _mib(count: float) -> str:
    return f"{count / MIB:,.1f} MiB" if count >= 10 * MIB else f"{count / MIB:.3g} MiB"


def overview(cells: Iterable[Cell], catalog: Mapping[str, Method],
             limits: Limits | None = None) -> list[dict[str, Any]]:
    """A row per cell for `--dry-run`: what it is, the memory it should take, and `measure` or why not."""
    return [_row(cell, catalog, limits) for cell in cells]


def _row(cell: Cell, catalog: Mapping[str, Method], limits: Limits | None) -> dict[str, Any]:
    stats = expected_stats(cell.scene)
    decision = judge(cell, catalog, stats, limits)
    memory = Fitted(catalog[cell.method].variant(cell.params), stats).memory_bytes()
    return {"experiment": cell.experiment, "label": cell.label, "method": cell.method, "point": dict(cell.point),
            "scene": cell.scene.as_dict(), "memory_bytes": sum(memory.values()),
            "decision": ": ".join(decision) if decision else "measure"}


@lru_cache(maxsize=512)
def expected_stats(scene: Scene) -> SceneStats:
    """What a scene should come to, without making it: exact for block and tiles without rejected fragments.

    About right elsewhere: the fragments of slanted primitives are known when a device has drawn them.
    """
    covered = covered_pixels(scene)
    counts = _whole_pixels(_expected_counts(scene), covered)
    histogram = (counts[0] + scene.size[0] * scene.size[1] - covered, *counts[1:])
    fragments = sum(f * pixels for f, pixels in enumerate(histogram))
    return SceneStats(
        *scene.size, n=max(1, len(histogram) - 1), F=fragments, primitives=quad_count(scene), histogram=histogram,
        rejects=scene.fragment_probability < 1 or scene.least_depth is not None,
        geometry="quad" if is_flat(scene) else "strip", least=least_layers(scene))


def _expected_counts(scene: Scene) -> list[float]:
    """The covered pixels expected to have 0, 1, 2, … fragments."""
    if has_mean_depth(scene):
        return _layered_counts(scene)
    if scene.least_depth:
        return _drawn_counts(scene)
    if scene.layout != "random":
        return _binomial_mix(scene.depth_complexity, {scene.fragment_probability: covered_pixels(scene)})
    chances: dict[float, float] = defaultdict(float)
    (width, height), (w, h) = block(scene.size, scene.pixel_density), quad_size(scene)
    across, down = _strips(width, w), _strips(height, h)
    for x in across:
        for y in down:
            chances[x * y * scene.fragment_probability] += covered_pixels(scene) / (len(across) * len(down))
    return _binomial_mix(quad_count(scene), chances)


def _drawn_counts(scene: Scene) -> list[float]:
    """Each pixel draws its number of fragments evenly, and keeps each with the fragment probability."""
    least, most = least_layers(scene), scene.depth_complexity
    share = covered_pixels(scene) / (most - least + 1)
    counts = [0.0] * (most + 1)
    for layers in range(least, most + 1):
        for hits, probability in _binomial(layers, scene.fragment_probability):
            counts[hits] += share * probability
    return counts


def _layered_counts(scene: Scene) -> list[float]:
    """As if each layer covered a part of what the one before it covers."""
    covered, layers = covered_pixels(scene), scene.depth_complexity
    ends = [*shares(layers, min(float(layers), mean_depth(scene))), 0.0]
    counts = [covered * (1.0 - ends[0])] + [covered * (share - after) for share, after in pairwise(ends)]
    if scene.fragment_probability == 1:
        return counts
    thinned = [0.0] * (layers + 1)
    for deep, pixels in enumerate(counts):
        for hits, probability in _binomial(deep, scene.fragment_probability):
            thinned[hits] += pixels * probability
    return thinned


def _strips(length: int, quad: int, most: int = 16) -> list[float]:
    """Chance that a randomly placed quad covers the middle of each of `most` equal strips of the block's side."""
    strips = min(most, length)
    middles = [(2 * i + 1) * length // (2 * strips) for i in range(strips)]
    places = length - quad + 1
    return [(min(x, places - 1) - max(0, x - quad + 1) + 1) / places for x in middles]


def _binomial_mix(trials: int, pixels_by_chance: Mapping[float, float]) -> list[float]:
    """Pixels expected to have 0, 1, … hits of `trials`, for pixels of each chance of a hit."""
    counts: dict[int, float] = defaultdict(float, {0: 0.0})
    for chance, pixels in pixels_by_chance.items():
        for hits, probability in _binomial(trials, chance):
            counts[hits] += pixels * probability
    return [counts.get(hits, 0.0) for hits in range(max(counts) + 1)]


def _binomial(trials: int, chance: float) -> list[tuple[int, float]]:
    """The binomial distribution within nine deviations of its mean."""
    if chance >= 1 or trials == 0:
        return [(trials, 1.0)]
    mean, reach = trials * chance, 9 * math.sqrt(trials * chance * (1 - chance)) + 9
    low, high = max(0, int(mean - reach)), min(trials, int(mean + reach))
    return [(i, math.exp(math.lgamma(trials + 1) - math.lgamma(i + 1) - math.lgamma(trials - i + 1)
                         + i * math.log(chance) + (trials - i) * math.log1p(-chance))) for i in range(low, high + 1)]


def _whole_pixels(counts: Sequence[float], total: int) -> list[int]:
    """The counts in whole pixels that add up to `total`, without zeros at the end."""
    ends = [min(total, round(end)) for end in accumulate(counts)]
    ends[-1] = total
    whole = [end - start for start, end in pairwise([0, *ends])]
    while len(whole) > 1 and not whole[-1]:
        whole.pop()
    return whole

"""The cells of an experiment, in the order that shares most work."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from ..config.axes import measure_at, points, scene_at
from ..config.settings import Measure, MethodEntry
from ..environment import MIB
from ..errors import UsageError, one_of
from ..methods import FLOOR
from ..methods.spec import Decided, Method, Value
from ..scene import Scene
from ..scene.spec.values import told

if TYPE_CHECKING:
    from ..config.model import Experiment


@dataclass(frozen=True)
class Cell:
    """One point to measure: a method, all its parameters, a scene. `point` is where the axes that matter to it are.

    `k_saves_passes`: more k is not more work, for the geometry is drawn less often. `place`: the number of the cell in
    the whole plan of its experiment, of which a share of a run has a part.
    """

    experiment: str
    method: str
    label: str
    params: Mapping[str, Value]
    scene: Scene
    measure: Measure
    point: Mapping[str, Any]
    k_saves_passes: bool = False
    place: int = field(default=0, compare=False)

    @property
    def identity(self) -> tuple:
        """Equal for cells that show the same number in the same series."""
        return self.method, self.label, tuple(sorted(self.params.items())), self.scene, self.measure


def expand(experiment: Experiment, catalog: Mapping[str, Method], only: Sequence[str] | None = None) -> list[Cell]:
    """The cells of an experiment: those of a scene together, scenes in the order of the sweep.

    Cells that would be measured alike appear once. The floor is measured for every scene that has another
    cell. `only` keeps the methods of these ids. Raises UsageError for an id that is not in the catalog.
    """
    entries = _chosen(experiment.methods, catalog, only)
    scenes: dict[Scene, Scene] = {}  # equal ones are one object, whose record and statistics are made once
    measures: dict[Measure, Measure] = {}
    by_scene: dict[Scene, dict[tuple, Cell]] = defaultdict(dict)
    for point in points(experiment.sweep, experiment.zip) if entries else ():
        scene = scene_at(experiment.scene, experiment.params, point)
        measure = measure_at(experiment.measure, point)
        scene, measure = scenes.setdefault(scene, scene), measures.setdefault(measure, measure)
        cells = by_scene[scene]
        for entry in entries:
            cell = _cell(experiment, catalog[entry.id], entry, point, scene, measure)
            cells.setdefault(cell.identity, cell)
    found = [cell for cells in by_scene.values() for cell in cells.values()]
    return [replace(cell, place=place) for place, cell in enumerate(found)]


def _chosen(entries: Sequence[MethodEntry], catalog: Mapping[str, Method],
            only: Sequence[str] | None) -> list[MethodEntry]:
    """The entries to measure, the floor first where it is not listed."""
    unknown = [i for i in only or () if i not in catalog]
    if unknown:
        raise UsageError(f"--only: unknown method {i!r}; {one_of(i, catalog, 'mfr-bench methods')}"
                         for i in unknown)
    chosen = [e for e in entries if only is None or e.id in only]
    wanted = chosen or FLOOR in (only or ())
    if not wanted or FLOOR not in catalog or any(e.id == FLOOR for e in chosen):
        return chosen
    listed = [e for e in entries if e.id == FLOOR]
    return [*(listed or [MethodEntry(FLOOR, catalog[FLOOR].name, {})]), *chosen]


def _budgeted(method: Method, measure: Measure) -> dict[str, Value]:
    """The memory that a method which decides by it may take where nothing else is given: no more than any method."""
    decided = method.capacity
    if not isinstance(decided, Decided):
        return {}
    own, allowed = method.param(decided.budget), measure.memory_budget_mb
    return {own.name: min(own.default, max(allowed / 2, allowed - decided.beside / MIB))}


def _cell(experiment: Experiment, method: Method, entry: MethodEntry, point: Mapping[str, Any], scene: Scene,
          measure: Measure) -> Cell:
    params = method.complete({**_budgeted(method, measure), **experiment.params, **point, **entry.params})
    with_r = "r" in experiment.params or "r" in point
    mine = {key: told(value) for key, value in point.items()
            if "." in key or (key in params and key not in entry.params) or (with_r and key in ("r", "k"))}
    return Cell(experiment.name, entry.id, entry.label, params, scene, measure, mine, method.k_saves_passes)

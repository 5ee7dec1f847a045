"""The cells that a device, a method or a budget forbids, found before anything is allocated."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from ..environment import MIB
from ..methods.spec import (
    FRAMEBUFFER_FETCH,
    MSAA_FEATURES,
    SCENE_FACTS,
    Decided,
    Fitted,
    Method,
    Param,
    Planned,
    SceneStats,
    Variant,
    Variants,
)
from ..scene.kinds import kind_of
from .cells import Cell
from .expected import expected_stats

Decision = tuple[Literal["unsupported", "over_budget"], str]


@dataclass(frozen=True)
class Limits:
    """The limits and features of a device."""

    features: frozenset[str]
    max_block_bytes: int  # largest shader storage block
    max_texture_size: int  # pixels, either side
    max_local_array: int | None = None  # fragments in a shader's local array, where more would compile for minutes
    failed_trials: Mapping[str, str] = field(default_factory=dict)  # of a feature that the driver claims and gets wrong

    def lacks(self, feature: str) -> str:
        """The feature, with the trial that it fails where the driver claims it."""
        return f"{feature}, which fails {self.failed_trials[feature]}" if feature in self.failed_trials else feature


def features_for(cells: Iterable[Cell], catalog: Mapping[str, Method]) -> frozenset[str]:
    """The features on which it depends what becomes of these cells: a device need not be tried for others.

    Those of a parameter's other values belong to them where the chosen one needs a feature: `_most` looks at them.
    """
    variants, found = Variants(catalog), set()
    for cell in cells:
        variant, stats = variants.of(cell.method, cell.params), expected_stats(cell.scene)
        found.update(variant.method.needs, () if stats.one_sample else (MSAA_FEATURES[stats.samples],),
                     (FRAMEBUFFER_FETCH,) if isinstance(variant.method.capacity, Planned) else ())
        for param in variant.acting:
            found.update(param.needs.values() if param.need(variant.params) else ())
    return frozenset(found)


def _missing(variant: Variant, stats: SceneStats, limits: Limits) -> list[str]:
    """The features that variant and scene need and the device lacks, in words; for a number, how large it may be."""
    wanted = (*variant.method.needs, *([] if stats.one_sample else [MSAA_FEATURES[stats.samples]]))
    found = [limits.lacks(f) for f in wanted if f not in limits.features]
    for param in variant.acting:
        feature = param.need(variant.params)
        if feature and feature not in limits.features:
            most = None if param.choices or param.of or param.real else _most(variant, param, limits)
            found.append(limits.lacks(feature) + (f": without it {param.name} is at most {most}" if most else ""))
    return found


def _most(variant: Variant, param: Param, limits: Limits) -> int | None:
    """The largest value below the chosen one that the device allows; None where it allows the next one as well."""
    def allowed(value: int) -> bool:
        feature = param.need({**variant.params, param.name: value})
        return feature is None or feature in limits.features

    if allowed(int(variant.params[param.name]) + 1):
        return None
    return next(filter(allowed, range(int(variant.params[param.name]), int(param.low) - 1, -1)), None)


def judge(cell: Cell, catalog: Mapping[str, Method], stats: SceneStats, limits: Limits | None) -> Decision | None:
    """The reason why a cell is not measured, or None. Without limits only the budget is checked."""
    features = limits.features if limits else frozenset()
    fitted = Fitted(catalog[cell.method].variant(cell.params), stats, features)
    return _judged(cell, fitted, limits)


def _judged(cell: Cell, fitted: Fitted, limits: Limits | None) -> Decision | None:
    """The decision of `judge` on a cell that is fitted to its scene already."""
    variant, stats = fitted.variant, fitted.stats
    if lacks := kind_of(cell.scene).lacks(cell.scene):
        return "unsupported", f"needs {lacks}"
    missing = _missing(variant, stats, limits) if limits else []
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
        needed, own = _apart(least, allowed)
        return "over_budget", f"needs at least {needed}, {variant.method.capacity.budget} allows it {own}"
    memory = fitted.memory_bytes()
    for buffer in variant.buffers:
        if limits and memory[buffer.name] > limits.max_block_bytes:
            needed, block = _apart(memory[buffer.name], limits.max_block_bytes)
            return "over_budget", f"needs {needed} for {buffer.name}, the device allows {block} in a storage block"
    return _over(sum(memory.values()), cell.measure.memory_budget_mb, variant)


def _over(total: int, budget_mb: float, variant: Variant) -> Decision | None:
    """Whether a cell of so many bytes exceeds the memory budget, with the parameter by which the method may keep it."""
    if total <= budget_mb * MIB:
        return None
    own = variant.method.capacity
    name = own.budget if isinstance(own, (Decided, Planned)) else None
    keeps = f"; {name}={budget_mb:g} may keep it" if name and not 0 < variant.scope[name] <= budget_mb else ""
    needed, budget = _apart(total, budget_mb * MIB)
    return "over_budget", f"needs {needed}, the budget is {budget}{keeps}"


def _apart(more: float, less: float) -> tuple[str, str]:
    """Two numbers of bytes, in MiB with as many digits as tell them apart."""
    digits = next((digits for digits in range(10) if _mib(more, digits) != _mib(less, digits)), 0)
    return _mib(more, digits), _mib(less, digits)


def _mib(count: float, digits: int = 0) -> str:
    """Bytes in MiB. digits: that are told beside the usual ones."""
    return f"{count / MIB:,.{1 + digits}f} MiB" if count >= 10 * MIB else f"{count / MIB:.{3 + digits}g} MiB"


def overview(cells: Iterable[Cell], catalog: Mapping[str, Method],
             limits: Limits | None = None) -> list[dict[str, Any]]:
    """A row per cell for `--dry-run`: what it is, the memory it should take, and `measure` or why not."""
    variants, scenes, rows = Variants(catalog), {}, []
    for cell in cells:
        if cell.scene not in scenes:
            scenes[cell.scene] = cell.scene.as_dict()
        rows.append(_row(cell, scenes[cell.scene], variants, limits))
    return rows


def forbidden(cells: Mapping[str, Cell], catalog: Mapping[str, Method], limits: Limits) -> set[str]:
    """The keys of the cells that the device, the method or the memory budget forbids."""
    variants = Variants(catalog)
    return {key for key, cell in cells.items() if _judged(cell, _fitted(cell, variants, limits), limits)}


def _fitted(cell: Cell, variants: Variants, limits: Limits | None) -> Fitted:
    features = limits.features if limits else frozenset()
    return Fitted(variants.of(cell.method, cell.params), expected_stats(cell.scene), features)


def _row(cell: Cell, scene: dict[str, Any], variants: Variants, limits: Limits | None) -> dict[str, Any]:
    fitted = _fitted(cell, variants, limits)
    decision = _judged(cell, fitted, limits)
    return {"experiment": cell.experiment, "label": cell.label, "method": cell.method, "point": dict(cell.point),
            "scene": scene, "memory_bytes": sum(fitted.memory_bytes().values()),
            "decision": ": ".join(decision) if decision else "measure"}

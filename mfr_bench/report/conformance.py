"""docs/conformance.md from results: which images were right, and what methods with hazards kept, lost and repeated."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from ..errors import StoreError, nearest
from ..markdown import filled
from ..methods import FLOOR
from ..methods.shared import STORED
from ..methods.spec import Method, Variant
from . import data
from .conformance_meshes import is_of_mesh, section
from .data import Point, Result, number
from .tables import Grid

HEAD = """# Conformance

Every method against the float64 oracle, as `mfr-bench conformance DIR...` prints it from results of
`mfr-bench run conformance determinism`. Each number is the worst of all cells of its row: wrong pixels are those with a
channel error above 1/512 in one image; kept is how many fragments the method stored, counted in memory, over how many
it promises to, empty where it holds none; lost fragments are those that it counted itself; images are the distinct ones
of {frames}. A cell that the device cannot run is not counted as ok.
"""
HEADER = ("method", "id", "promise", "ok", "not run", "wrong", "max error", "wrong pixels", "kept", "lost", "images")
HAZARDS = ("method", "id", "known failure", "exact images", "wrong pixels", "kept", "lost", "images")
IN_ORDER = ("llvmpipe rasterizes each tile in order by one thread: hazards and races between the fragments of a pixel "
            "do not show there.")


def conformance_page(results: Iterable[Result], catalog: Mapping[str, Method]) -> str:
    """The page as Markdown. Raises StoreError for results of a method that the catalog lacks."""
    results = [r for r in results if r.points]
    variants: dict[str, Variant] = {}
    flat: dict[str, list[Point]] = {}
    meshes: dict[str, list[Point]] = {}
    for point in _distinct(results):
        variants.setdefault(point.label, _variant(catalog, point))
        (meshes if is_of_mesh(point) else flat).setdefault(point.label, []).append(point)
    of_meshes = [r for r in results if any(map(is_of_mesh, r.points))]
    parts = [HEAD.format(frames=_frames(_repeats(flat))), *_about([r for r in results if r not in of_meshes])]
    if flat:
        parts += [_coverage(flat), "## All methods",
                  _grid(HEADER, [_row(variants[label], label, points) for label, points in flat.items()]),
                  "## Methods with a known failure",
                  _grid(HAZARDS, [_hazard(variants[label], label, points) for label, points in flat.items()
                                  if variants[label].guarantee == "approximate"]),
                  "## What was not run", "\n".join(_not_run(flat))]
    parts += section(meshes, variants, _about(of_meshes), _not_run(meshes))
    parts += [] if variants else ["None of these results has a cell."]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"


def _frames(count: int) -> str:
    return "1 frame" if count == 1 else f"{count} frames"


def _repeats(series: Mapping[str, Sequence[Point]]) -> int:
    """The most frames whose images were told apart."""
    counts = (p.cell["measure"].get("repeat_images") for points in series.values() for p in points)
    return max((count for count in counts if isinstance(count, int)), default=1)


def _variant(catalog: Mapping[str, Method], point: Point) -> Variant:
    """The variant that a point measured. Raises StoreError where this version has none such."""
    where = f"{point.folder.cells_path / point.cell['key']}.json"
    if point.method not in catalog:
        raise StoreError(f"{where}: no method {point.method!r}; allowed: what 'mfr-bench methods' lists"
                         f"{nearest(point.method, catalog)}; remove its cell, or, if the method is from outside, name "
                         "its folder in MFR_BENCH_METHODS")
    try:
        return catalog[point.method].variant(point.cell["params"])
    except (ValueError, TypeError, KeyError) as error:
        raise StoreError(f"{where}: params of {point.method}: {error}; measure its cell again, or remove it") from error


def _distinct(results: Iterable[Result]) -> list[Point]:
    """List every cell once: several results may have the same, as all have the cell of the floor."""
    return list({p.cell["key"]: p for r in results for p in r.points}.values())


def _about(results: Sequence[Result]) -> list[str]:
    """Name, cells, axes and device; one paragraph for results that have all of these in common."""
    alike: dict[tuple[str, str, str], list[Result]] = {}
    for result in results:
        swept = (result.manifest.get("sweep") or {}).items()
        axes = "; ".join(f"{data.short(axis)} {', '.join(map(data.plain, found))}" for axis, found in swept)
        alike.setdefault((result.name, axes, result.provenance), []).append(result)
    return [_paragraph(*place, found) for place, found in alike.items()]


def _paragraph(name: str, axes: str, provenance: str, results: Sequence[Result]) -> str:
    lines = [f"`{name}`, {len(_distinct(results))} cells{f' ({axes})' if axes else ''}. {provenance}."]
    if "llvmpipe" in provenance:
        lines.append(IN_ORDER)
    if unmeasured := sum(result.unmeasured for result in results):
        lines.append(f"{data.without_record(unmeasured)} yet.")
    return filled(" ".join(lines))


def _coverage(series: Mapping[str, Sequence[Point]]) -> str:
    """Tell how many methods and variants, the floor aside, ran in every cell without a wrong image."""
    methods = [points for points in series.values() if points[0].method != FLOOR]
    whole = sum(all(p.ending.image == "right" for p in points) for points in methods)
    share = f"{100 * whole / max(1, len(methods)):.1f} %"
    return filled(f"{whole} of {len(methods)} methods and variants ({share}) ran in every cell without a wrong image.")


def _grid(header: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    return Grid("", "", header, tuple(rows), left=3).markdown()


def _worst(points: Sequence[Point], column: str, worst=max, digits: int = 3) -> str:
    return number(worst((p.row[column] for p in points if p.row[column] is not None), default=None), digits)


def _kept(variant: Variant, points: Sequence[Point]) -> str:
    """Smallest share of the promised fragments that was stored; empty for a method that stores none to be counted."""
    if not any(step.probes == STORED for step in variant.passes):
        return ""
    shares = [p.row["hit_ratio"] / p.row["promised_ratio"] for p in points
              if p.row["hit_ratio"] is not None and p.row["promised_ratio"]]
    return number(min(shares, default=None), 4)


def _row(variant: Variant, label: str, points: Sequence[Point]) -> tuple[str, ...]:
    ok, wrong = (sum(p.ending.image == image for p in points) for image in ("right", "wrong"))
    return (label, f"`{variant.method.id}`", variant.guarantee, str(ok), str(len(points) - ok - wrong), str(wrong),
            _worst(points, "max_abs_error", digits=2), _worst(points, "wrong_pixels"), _kept(variant, points),
            _worst(points, "lost_fragments"), _worst(points, "distinct_images"))


def _hazard(variant: Variant, label: str, points: Sequence[Point]) -> tuple[str, ...]:
    checked = [p.exact for p in points if p.exact is not None]
    failure = "; ".join(filter(None, (variant.method.failure, *variant.weaknesses)))
    return (label, f"`{variant.method.id}`", failure, f"{sum(checked)} of {len(checked)}",
            _worst(points, "wrong_pixels"), _kept(variant, points), _worst(points, "lost_fragments"),
            _worst(points, "distinct_images"))


def _not_run(series: Mapping[str, Sequence[Point]]) -> list[str]:
    """A line for each label and reason."""
    counts: dict[tuple[str, str], int] = {}
    for label, points in series.items():
        for p in points:
            if not p.ending.timed:
                reason = f"{p.sign}: {p.cell.get('reason')}"
                counts[label, reason] = counts.get((label, reason), 0) + 1
    return [filled(f"{label}: {count} cell{'s' * (count > 1)} {reason}", "- ")
            for (label, reason), count in counts.items()] or ["Nothing."]

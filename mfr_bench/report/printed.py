"""The papers' printed numbers, matched with the measured ones.

A config names the quantities of results/reference that belong beside it in `source.prints`. What a quantity is here is
a measure of a cell; a quantity without one (a speed-up, a peak) is a claim's, and is only quoted.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ..methods.spec import SceneStats, evaluate
from ..stats import Interval
from .data import Point, Result, number
from .reference import Printed, find

Here = Callable[[Point], Interval]


def _column(name: str) -> Here:
    return lambda point: (None, point.row[name], None)


def _measure(name: str) -> Here:
    return lambda point: point.measure(name)


def _pass(*names: str) -> Here:
    return lambda point: point.pass_ms(names)


def _mean_depth(point: Point) -> Interval:
    fragments, pixels = point.row["fragments"], point.row["covered_pixels"]
    return None, fragments / pixels if fragments is not None and pixels else None, None


HERE: Mapping[str, Here] = {
    "memory": _measure("memory_mib"), "words_per_pixel": _measure("words_per_pixel"), "frame_rate": _measure("fps"),
    "geometry_passes": _column("geometry_passes"), "k_chosen": _column("chosen_k"),
    "referencing_time": _pass("referencing", "scan", "store"), "render_time": _pass("render"),
    "fragments": _column("fragments"),
    "mean_depth_complexity": _mean_depth, "depth_complexity": _column("max_fragments"),
}
MOST_TIMES = 64  # that a viewport may be smaller than a printed one
BY_PIXELS = ("memory", "fragments")  # grow with the viewport's pixels
BOUNDS = {"about": "about ", "from": "from ", "to": "to ", "up to": "up to ", "above": "above ", "below": "below "}
UNITS = {"fragments": "", "times": "×", "32-bit words": "words", "frames per second": "fps"}


def rows(result: Result) -> list[Printed]:
    """The printed numbers that the result's config asks for, in the order of the reference files."""
    source = result.manifest.get("source") or {}
    quantities = source.get("prints") or []
    return [row for quantity in quantities if isinstance(quantity, str)
            for row in _of_quantity(source.get("paper"), source.get("figure"), quantity)]


def _of_quantity(paper: str | None, figure: str | None, quantity: str) -> list[Printed]:
    """The rows of the figure itself; where the paper prints the quantity for no figure, those of the text."""
    found = find(paper=paper, quantity=quantity)
    own = [row for row in found if figure in (row.figure, f"§{row.section}")]
    return own or [row for row in found if row.figure is None]


@dataclass(frozen=True)
class Match:
    """A cell that a printed number is about, and the scale between the paper's viewport and this one."""

    point: Point
    scale: int  # the paper's width / this one's

    def printed_here(self, row: Printed) -> float | None:
        """The printed value as a mark in a figure of these cells, by pixels where it grows with them."""
        if row.value is None:
            return _by_formula(row.formula, self.point) if row.formula else None
        return row.value / self.scale**2 if row.quantity in BY_PIXELS else row.value


def _by_formula(formula: str, point: Point) -> float | None:
    """A printed formula's value for the cell: n, k, f, and f_k, the mean of the fragments that are kept."""
    row, k = point.row, point.at("k")
    if not row["fragments"] or not row["max_fragments"] or not isinstance(k, int):
        return None
    stats = SceneStats(W=row["width"], H=row["height"], n=row["max_fragments"], F=row["fragments"], primitives=1)
    if "f_k" not in formula:
        return evaluate(formula, stats, {"k": k})
    share = row["promised_ratio"] if row["promised_ratio"] is not None else row["hit_ratio"]
    return None if share is None else evaluate(formula, stats, {"f_k": share * stats.F / stats.P})


def matches(row: Printed, points: Iterable[Point]) -> list[Match]:
    """The cells that a number is about: its method, its k and density, its viewport or that divided by a number."""
    if row.quantity not in HERE or _of_a_variant(row):
        return []
    points = list(points)
    scale = _scale(row, points)
    return [Match(p, scale) for p in points
            if (row.method is None or p.method == row.method) and _alike(row, p) and _fits(row, p, scale)]


def _of_a_variant(row: Printed) -> bool:
    """Whether the number is of a variant, such as attribute packing, of what the paper also prints without it."""
    plain = find(paper=row.paper, figure=row.figure, quantity=row.quantity, method=row.method, condition=None)
    return row.condition is not None and row.method is not None and bool(plain)


def _alike(row: Printed, point: Point) -> bool:
    for wanted, name in ((row.k, "k"), (row.pixel_density, "pixel_density"),
                         (row.fragment_probability, "fragment_probability")):
        here = point.at(name)
        if wanted is not None and here is not None and not isinstance(here, str) and abs(here - wanted) > 1e-6 * wanted:
            return False
    return True


def _scale(row: Printed, points: Sequence[Point]) -> int:
    """The factor by which each side is smaller here: the one that most of the quantity's scaled viewports meet."""
    here = {(p.row["width"], p.row["height"]) for p in points}
    printed = {(r.width, r.height) for r in find(paper=row.paper, quantity=row.quantity) if r.width and r.height}
    met = {scale: sum((w * scale, h * scale) in printed for w, h in here) for scale in range(1, MOST_TIMES + 1)}
    return max(met, key=lambda scale: (met[scale], -scale))


def _fits(row: Printed, point: Point, scale: int) -> bool:
    """Whether the point's viewport is the printed one, scaled; any is where none is printed."""
    if row.width is None or row.height is None:
        return True
    return (row.width, row.height) == (point.row["width"] * scale, point.row["height"] * scale)


def value_text(row: Printed) -> str:
    """'up to 3.5 ×', '2*k + 2 words'; what the paper's own formula gives where that differs from the print."""
    unit = UNITS.get(row.unit or "", row.unit or "")
    value = row.formula if row.value is None else f"{row.value:,.10g}"
    text = f"{BOUNDS.get(row.bound or '', '')}{value}{f' {unit}' if unit else ''}"
    return f"{text} (slip: {number(row.recomputed)} follows)" if row.recomputed is not None else text


def _places(row: Printed) -> list[str]:
    parts = [f"{row.width}×{row.height}" if row.width and row.height else None]
    parts += [f"{short} {value:g}" for short, value in (("p_d", row.pixel_density), ("f_p", row.fragment_probability),
                                                        ("n", row.n), ("k", row.k)) if value is not None]
    return [part for part in (*parts, row.condition) if part]


def _shared(members: Sequence[Printed]) -> str:
    """The conditions that all of several numbers were printed for."""
    first, *others = map(_places, members)
    return ", ".join(part for part in first if others and all(part in other for other in others))


def names(members: Sequence[Printed]) -> list[str]:
    """The subject of each number: 'memory · FreePipe · 640×480'; what all of a quantity share is left out."""
    of_quantity: dict[str, list[Printed]] = {}
    for row in members:
        of_quantity.setdefault(row.quantity, []).append(row)
    shared = {quantity: _shared(rows).split(", ") for quantity, rows in of_quantity.items()}
    return [" · ".join(part for part in (row.quantity.replace("_", " "), row.name, ", ".join(
        p for p in _places(row) if p not in shared[row.quantity])) if part) for row in members]


def here_text(row: Printed, points: Sequence[Point]) -> str:
    """The measured counterpart: one cell's value with its place, or the range of several; empty where nothing was."""
    found = [(HERE[row.quantity](m.point)[1], m) for m in matches(row, points) if m.point.status == "ok"]
    found = [(value, m) for value, m in found if value is not None]
    if not found:
        return ""
    low, high = min(v for v, _ in found), max(v for v, _ in found)
    text = number(low) if number(low) == number(high) else f"{number(low)} to {number(high)}"
    sizes = {(m.point.row["width"], m.point.row["height"]) for _, m in found}
    size = "×".join(map(str, sizes.pop())) if len(sizes) == 1 else ""
    return f"{text} at {size}" if size and row.width and (row.width, row.height) != tuple(
        map(int, size.split("×"))) else text


def notes(result: Result) -> list[str]:
    """One line of small print: the numbers, by quantity and name, and the devices they were measured on."""
    groups: dict[tuple[str, str], list[Printed]] = {}
    for row in rows(result):
        groups.setdefault((row.quantity, row.device or ""), []).append(row)
    texts = [f"{quantity.replace('_', ' ')}{f' on {device}' if device else ''}"
             f"{f' ({shared})' if (shared := _shared(members)) else ''}: {'; '.join(_named(members))}"
             for (quantity, device), members in groups.items()]
    return [f"The paper prints {' · '.join(texts)}."] if texts else []


def _named(members: Sequence[Printed]) -> list[str]:
    """'PreCalc_Fixed 0.027 ms, 0.05 ms, 0.11 ms (640×480, 1024×768, 1600×1200)'; equal places are named once."""
    by_name: dict[str, list[Printed]] = {}
    for row in members:
        by_name.setdefault(row.name or "", []).append(row)
    shared = _shared(members).split(", ")
    return [" ".join(part for part in (name, ", ".join(_with_places(of_name, shared))) if part)
            for name, of_name in by_name.items()]


def _with_places(members: Sequence[Printed], shared: Sequence[str]) -> Iterator[str]:
    """Each number with its place; the ends of a range, of one place, as one: 'from 5 × to 7 × (over S-buffer)'."""
    at = 0
    while at < len(members):
        pair = members[at:at + 2]
        both = [row.bound for row in pair] == ["from", "to"] and _places(pair[0]) == _places(pair[1])
        ends = pair if both else pair[:1]
        place = ", ".join(part for part in _places(ends[0]) if part not in shared)
        yield " ".join(_plainly(row) for row in ends) + (f" ({place})" if place else "")
        at += len(ends)


def _plainly(row: Printed) -> str:
    """The number without a unit that is the quantity's own name: of 'geometry passes' 2, not '2 passes'."""
    words = row.quantity.split("_")
    return value_text(replace(row, unit=None) if UNITS.get(row.unit or "", row.unit) in words else row)

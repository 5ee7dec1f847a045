"""A picture of what races do to k-buffers, simulated: each pixel is one schedule of its fragments on the race machine.

It stands beside kplus_2015, Fig. 10, whose panels are black on a software driver.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..environment import usable_cores
from ..hashing import hash3
from ..methods.spec import Method, Variant
from ..report import style
from ..report.figures.files import render
from ..report.figures.kinds.maps import over_checks
from ..report.figures.sheet import EDGE, FigureSheet, fitted, styled
from ..scene.quads import Quads
from ..store import csv_text, write_file
from .campaign import settings
from .check import Checker, How
from .hazards import promising_nothing
from .scenes import DEPTH_STEPS, row_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAME = "simulated-kplus2015-fig10"
SIDE, QUADS = 72, 34  # pixels of the picture, and quads in it
LEAST_SIDE, MOST_SIDE = 21, 39  # pixels of a quad
K, IN_FLIGHT, SEED = 4, 4, 7
SEEN = 1 / 255  # one step of 8 bits
PLACE, SIZE, COLOUR = 11, 12, 13  # streams of the hash
COLUMNS = ("simulated", "panel", "width", "height", "quads", "k", "in_flight", "wrong_pixels_share", "mean_error",
           "max_error")
GAP, HEADING, BAR = 0.08, 0.3, 0.46  # inches


@dataclass(frozen=True)
class Panel:
    """The picture of one variant: float64 (H, W, 4), and its largest channel error by pixel."""

    label: str
    variant: Variant
    image: np.ndarray
    error: np.ndarray

    @property
    def wrong_share(self) -> float:
        """Share of the pixels that differ by more than one step of 8 bits."""
        return float((self.error > SEEN).mean())


def scene() -> Quads:
    """Overlapping quads at random places: in a flat region every pixel should look like its neighbours."""
    def drawn(stream: int, channel: int, count: int) -> np.ndarray:
        return np.array([hash3(i, SEED, 16 * stream + channel) % count for i in range(QUADS)])

    width, height = (LEAST_SIDE + drawn(SIZE, axis, MOST_SIDE - LEAST_SIDE) for axis in (0, 1))
    x, y = (drawn(PLACE, axis, SIDE) - LEAST_SIDE // 2 for axis in (0, 1))
    rect = np.clip(np.stack([x, y, x + width, y + height], axis=-1), 0, SIDE).astype(np.int32)
    depth = np.float32(np.argsort([hash3(i, SEED, PLACE) for i in range(QUADS)]) + 8) / np.float32(DEPTH_STEPS)
    rgba = np.stack([*(drawn(COLOUR, c, 224) + 32 for c in range(3)), drawn(COLOUR, 3, 128) + 26], axis=-1)
    return Quads((SIDE, SIDE), rect, depth, rgba.astype(np.uint8), 1.0, SEED)


def racing(catalog: Mapping[str, Method]) -> list[Variant]:
    """The variants that are shown to race: of exact methods one for each family, else all that promise nothing.

    A method promises nothing at its defaults, or with an option such as fewer passes. Methods that
    merge fragments are left out: their images differ by the order alone.
    """
    families: set[str] = set()
    chosen = []
    for method in catalog.values():
        variant = None if method.mixes else promising_nothing(method, K)
        exact = method.guarantee.startswith("exact")
        if variant and not (exact and method.family in families):
            chosen.append(variant)
            families |= {method.family} if exact else set()
    return chosen


def sound(catalog: Mapping[str, Method]) -> list[Variant]:
    """The variants that are shown to keep their promise: of each family the first with exactly the k nearest."""
    first = {m.family: m for m in reversed(catalog.values()) if m.guarantee == "exact k nearest" and m.param("k")}
    return [m.variant({"k": K}) for m in catalog.values() if first.get(m.family) is m]


def panels(variants: Sequence[Variant], at_once: int | None = None) -> list[Panel]:
    """A panel for each variant, whose k is K."""
    drawn = scene()
    with ThreadPoolExecutor(at_once or usable_cores()) as pool:
        return list(pool.map(lambda variant: _panel(variant, drawn), variants))


def _panel(variant: Variant, drawn: Quads) -> Panel:
    inside = [_fragments(drawn, x, y) for y in range(SIDE) for x in range(SIDE)]
    checker = Checker(variant, row_of((max(map(len, inside)),)))
    image, alone = (checker.picture(drawn, inside, How(seed=SEED, in_flight=flight)).reshape(SIDE, SIDE, 4)
                    for flight in (IN_FLIGHT, 1))
    said = ", ".join(f"{name}: {value}" for name, value in settings(variant, "k").items())
    label = f"{variant.method.name} ({said})" if said else variant.method.name
    return Panel(label, variant, image, np.abs(image - alone).max(axis=-1))


def _fragments(drawn: Quads, x: int, y: int) -> list[int]:
    """The quads that cover a pixel, in order of submission."""
    r = drawn.rect
    return np.flatnonzero((r[:, 0] <= x) & (x < r[:, 2]) & (r[:, 1] <= y) & (y < r[:, 3])).tolist()


def write(above: Sequence[Panel], below: Sequence[Panel], folder: Path) -> list[Path]:
    """Write the figure as PNG and SVG, and a row for each panel as CSV. Raises StoreError."""
    with styled():
        contents = {f".{suffix}": content for suffix, content in render(figure(above, below)).items()}
    contents[".csv"] = _table([*above, *below])
    for suffix, content in contents.items():
        write_file(folder / f"{NAME}{suffix}", content)
    return [folder / f"{NAME}{suffix}" for suffix in contents]


def _table(made: Sequence[Panel]) -> bytes:
    rows = (dict(zip(COLUMNS, (True, p.label, SIDE, SIDE, QUADS, K, IN_FLIGHT, f"{p.wrong_share:.6f}",
                               f"{p.error.mean():.6f}", f"{p.error.max():.6f}"), strict=True)) for p in made)
    return csv_text(COLUMNS, rows)


def figure(above: Sequence[Panel], below: Sequence[Panel]) -> Figure:
    """Images and errors of those that race, errors of those that do not, all errors on one scale."""
    columns = max(len(above), len(below))
    width = (style.WIDTH_IN - 2 * EDGE - BAR - GAP * (columns - 1)) / columns
    row = width + HEADING + 0.06
    title = fitted("Simulated: k-buffers whose fragments race", style.TITLE_PT, style.WIDTH_IN, "bold")
    sheet = FigureSheet(style.WIDTH_IN, tuple(title), _small_print(), 3 * row)
    drawn = sheet.figure()
    highest = max(SEEN, *(float(p.error.max()) for p in (*above, *below)))
    last: Any = None
    for line, (shown, errors) in enumerate(((above, False), (above, True), (below, True))):
        for column, panel in enumerate(shown):
            axes = sheet.axes(drawn, EDGE + column * (width + GAP), line * row + HEADING, width, width)
            named = panel.label if line != 1 else ""
            last = _draw(axes, panel, named, highest if errors else None) or last
    bar = sheet.axes(drawn, EDGE + columns * (width + GAP), row + HEADING, 0.11, width)
    drawn.colorbar(last, cax=bar)
    bar.tick_params(labelsize=style.SMALL_PT)
    return drawn


def _draw(axes: Any, panel: Panel, named: str, highest: float | None) -> Any:
    """The image of a panel, or with the `highest` of a scale its errors, and what they were drawn with."""
    axes.set_xticks([])
    axes.set_yticks([])
    for side in axes.spines.values():
        side.set_visible(True)
    wrong = [f"{100 * panel.wrong_share:.1f} % wrong"] if highest is not None else []
    heading = "\n".join([*([named.replace(" (", "\n(")] if named else []), *wrong])
    axes.set_title(heading, loc="left", fontsize=style.SMALL_PT, pad=2.5, linespacing=1.0)
    if highest is not None:
        return axes.imshow(panel.error, origin="lower", interpolation="nearest", aspect="auto", cmap=style.MAP_COLOURS,
                           vmin=0.0, vmax=highest)
    axes.imshow(over_checks(np.uint8(np.round(np.clip(panel.image, 0, 1) * 255))), origin="lower",
                interpolation="nearest", aspect="auto")
    return None


def _small_print() -> tuple[str, ...]:
    drawn = ("Simulated by mfr-bench race on a CPU, from the methods' own GLSL: each pixel is one schedule of its "
             f"fragments, drawn at random or by priorities, at most {IN_FLIGHT} in flight; a load out of bounds gives "
             "0. No GPU drew this, and no measured cell holds it: how often a GPU meets such schedules cannot be told "
             "from it.")
    rows = ("First row: images. Second row: how far their channels are from the same frame with one fragment in flight "
            "at a time. Third row: the same of methods that keep their promise. One scale for all errors; wrong: more "
            "than one step of 8 bits (0.0039).")
    of = (f"Scene: {SIDE}×{SIDE} pixels, {QUADS} quads at random places, k = {K} (fragments kept per pixel), seed "
          f"{SEED}. Beside kplus2015, Fig. 10, which is black on a software driver.")
    lines = (drawn, rows, of)
    return tuple(part for line in lines for part in fitted(line, style.SMALL_PT, style.WIDTH_IN))

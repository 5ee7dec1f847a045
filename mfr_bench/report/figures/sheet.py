"""The frame of a figure: title, small print, and axes placed in inches."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...environment import draws_in_software
from ...store.columns import COLUMNS, names
from .. import printed, style
from ..data import Point, Result
from .glyphs import EM, Face, face_of
from .series import Options

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

POINTS = 72  # per inch
LEFT, RIGHT, EDGE = 0.76, 0.08, 0.07  # room for y labels; at the right; around text
HINTING = 1.03  # glyphs fitted to a screen's pixels are up to this much wider than their outlines
ERROR_ARRAYS = ("error", "loss", "max_abs_error", "wrong_pixels")
RACES = ("A software driver draws the fragments of a pixel one after another: errors by races between them, as on a "
         "GPU, do not show.")
SMALL_HINTING = 1.06  # of small print, besides
TOGETHER = re.compile(r"(?:mfr-bench |profile )?\S+(?: [=…] \S+)*")
LONG_LABEL = 24  # characters from which a label is broken where there is room
TITLE_IN, HEADING_IN, LEGEND_LINE_IN, SMALL_LINE_IN = 0.2, 0.2, 0.165, 0.112


def styled():
    """The library's defaults and this package's style, whatever the user's own matplotlibrc says."""
    import matplotlib as mpl

    _register_fonts()
    ours = {k: v for k, v in mpl.rcParamsDefault.items() if not k.startswith(("backend", "webagg", "date."))}
    return mpl.rc_context(ours | style.RC)


@cache
def _register_fonts() -> None:
    """The DejaVu fonts that come with matplotlib under a name of their own: a system may have another version."""
    from matplotlib import font_manager, get_data_path

    for path in sorted(Path(get_data_path(), "fonts", "ttf").glob("DejaVuSans*.ttf")):
        face = font_manager.ttfFontProperty(font_manager.get_font(path))
        if face.name == "DejaVu Sans":
            font_manager.fontManager.ttflist.append(replace(face, name=style.FONT))


def text_width(text: str, points: float, weight: str = "normal") -> float:
    """Width of one line of text."""
    return HINTING * _face(weight).setting(text).width / EM * points / POINTS


@cache
def _face(weight: str) -> Face:
    from matplotlib.font_manager import FontProperties

    _register_fonts()
    return face_of(FontProperties(family=style.RC["font.family"], weight=weight))


def lacking_glyphs(text: str) -> list[str]:
    """The characters that the figures' font has no glyph for, each once."""
    from matplotlib.font_manager import FontProperties, findfont, get_font

    _register_fonts()
    glyphs = get_font(findfont(FontProperties(family=style.RC["font.family"], size=10))).get_charmap()
    return [c for c in dict.fromkeys(text) if c.isprintable() and not c.isspace() and ord(c) not in glyphs]


def widest(texts: Iterable[str], points: float) -> float:
    return max((text_width(text, points) for text in texts), default=0.0)


@dataclass(frozen=True)
class FigureSheet:
    """A figure's frame: title on top, small print at the bottom, and the height between them.

    title, small: in lines that fit. said: all that the small print says, one text for each thing.
    """

    width: float
    title: tuple[str, ...]
    small: tuple[str, ...]
    body: float
    said: tuple[str, ...] = ()

    @property
    def height(self) -> float:
        return self.top + self.body + self.bottom

    @property
    def top(self) -> float:
        return EDGE + TITLE_IN * len(self.title) + 0.04

    @property
    def bottom(self) -> float:
        return EDGE + SMALL_LINE_IN * len(self.small) + 0.04

    def figure(self) -> Figure:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=(self.width, self.height))
        FigureCanvasAgg(figure)
        self._write(figure, self.title, self.height - EDGE, "top", fontsize=style.TITLE_PT, fontweight="bold")
        self._write(figure, self.small, EDGE, "bottom", fontsize=style.SMALL_PT, color=style.QUIET, linespacing=1.3,
                    label="\n".join(self.said))
        return figure

    def _write(self, figure: Figure, lines: Sequence[str], y: float, side: str, **look: Any) -> None:
        figure.text(EDGE / self.width, y / self.height, "\n".join(lines), ha="left", va=side, **look)

    def axes(self, figure: Figure, left: float, top: float, width: float, height: float, **shared: Any) -> Axes:
        """Axes whose upper left corner is `top` below the body's upper edge."""
        bottom = self.bottom + self.body - top - height
        return figure.add_axes((left / self.width, bottom / self.height, width / self.width, height / self.height),
                               **shared)

    def y(self, below: float) -> float:
        """Figure fraction of a place `below` the body's upper edge."""
        return (self.bottom + self.body - below) / self.height


def sheet_of(result: Result, options: Options, points: Sequence[Point], notes: Iterable[str], width: float,
             body: float) -> FigureSheet:
    """The frame of a figure of these points, whose scene its small print tells; without any, that of the result.

    width, body: in inches.
    """
    title = str(options.get("title") or result.manifest.get("title") or result.name)
    lines = (*notes, _on_races(result, options), result.lacking, *printed.notes(result), result.readings,
             result.scene_of(points or result.points), result.provenance)
    said = tuple(filter(None, lines))
    small = [part for line in said for part in fitted(line, style.SMALL_PT, width)]
    return FigureSheet(width, tuple(fitted(title, style.TITLE_PT, width, "bold")), tuple(small), body, said)


def small_print(figure: Figure) -> tuple[str, float]:
    """What a figure's small print says, a line for each thing, and the height in inches that it takes at the bottom."""
    for text in figure.texts:
        if text.get_label():
            return text.get_label(), EDGE + SMALL_LINE_IN * (text.get_text().count("\n") + 1)
    return "", 0.0


def _on_races(result: Result, options: Options) -> str:
    """The reason why errors that a paper's GPU shows do not show here."""
    device = result.manifest.get("device") or {}
    renderer = device.get("renderer") if isinstance(device, Mapping) else device
    shows_errors = options.get("kind") != "pareto" and options.get("y") in (*names(COLUMNS, "error"), *ERROR_ARRAYS)
    return RACES if shows_errors and draws_in_software(str(renderer or "")) else ""


def fitted(text: str, points: float, width: float, weight: str = "normal") -> list[str]:
    """The text in lines that fit between the edges, broken between words; 'k = 8' stays whole where it fits."""
    room = (width - 2 * EDGE) / (SMALL_HINTING if points < 7 else 1.0)
    if text_width(text, points, weight) <= room:
        return [text]
    gap = text_width("n n", points, weight) - text_width("nn", points, weight)
    lines, used = [], 0.0
    for word in _words(text, points, weight, room):  # word by word: words recur, and each is measured once
        own = text_width(word, points, weight)
        if lines and used + gap + own <= room:
            lines[-1], used = f"{lines[-1]} {word}", used + gap + own
        else:
            lines.append(word)
            used = own
    return lines


def _words(text: str, points: float, weight: str, room: float) -> Iterator[str]:
    """The words of a text, those around '=' and '…' as one unless that is wider than the room."""
    for words in TOGETHER.findall(text):
        yield from (words,) if text_width(words, points, weight) <= room else words.split()


def legend_columns(names: Sequence[str], width: float, points: float = 7.5) -> int:
    """Most columns of a legend that fits into `width`."""
    for columns in range(len(names), 1, -1):
        parts = [widest(names[i::columns], points) + 3.4 * points / 72 for i in range(columns)]
        if sum(parts) <= width:
            return columns
    return 1

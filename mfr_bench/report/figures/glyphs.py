"""Text as outlines of the figures' font. A glyph is read once, a word is set once, whatever figures they stand in."""

from __future__ import annotations

import unicodedata
import zlib
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.font_manager import FontProperties

EM = 100  # the type size of outlines and advances, in points
MOST_WORDS = 1 << 14  # that are kept
SHAPED = ("R", "AL", "AN", "NSM")  # classes of characters that do not simply follow one another from left to right


@dataclass(frozen=True, eq=False)
class Glyph:
    """An outline, its advance, and its lower and upper end, at a type size of EM; `name` is unique among all fonts."""

    name: str
    vertices: Any
    codes: Any
    advance: float
    bottom: float
    top: float

    @cached_property
    def svg(self) -> str:
        """The outline as the data of a path in an SVG file, whose y grows upwards as here."""
        from matplotlib.path import Path

        letters = {Path.MOVETO: "M", Path.LINETO: "L", Path.CURVE3: "Q", Path.CURVE4: "C"}
        return " ".join("z" if code == Path.CLOSEPOLY else f"{letters[code]}{' '.join(f'{v:.6g}' for v in places)}"
                        for places, code in Path(self.vertices, self.codes).iter_segments(simplify=False))


@dataclass(frozen=True, eq=False)
class Setting:
    """Glyphs at their places from the left, and the width of the whole, at a type size of EM."""

    glyphs: tuple[tuple[Glyph, float], ...]
    width: float

    @property
    def bottom(self) -> float:
        return min((glyph.bottom for glyph, _ in self.glyphs), default=0.0)

    @property
    def top(self) -> float:
        return max((glyph.top for glyph, _ in self.glyphs), default=0.0)

    @cached_property
    def outline(self) -> tuple[Any, Any]:
        """The vertices (N, 2) and codes (N,) of all glyphs together."""
        import numpy as np

        if not self.glyphs:
            return np.empty((0, 2)), np.empty(0, dtype=np.uint8)
        moved = [glyph.vertices + np.array((x, 0.0)) for glyph, x in self.glyphs]
        return np.concatenate(moved), np.concatenate([glyph.codes for glyph, _ in self.glyphs])


class Face:
    """The glyphs of one font file."""

    def __init__(self, path: str):
        from matplotlib.ft2font import Kerning, LoadFlags

        self._path = path
        self._flags, self._kerning = LoadFlags.NO_HINTING, Kerning.UNFITTED
        self._glyphs: dict[str, Glyph] = {}
        self._pairs: dict[tuple[str, str], float] = {}

    @property
    def _font(self) -> Any:
        """The open file of the font, which is this process's own: a copy would share its place in the file."""
        from matplotlib.font_manager import get_font

        return get_font(self._path)

    @cached_property
    def heights(self) -> tuple[float, float, float]:
        """Ascent, descent and gap between lines, at a type size of 1, as the font has them for typesetting."""
        table, unit = self._font.get_sfnt_table("OS/2"), self._font.get_sfnt_table("head")["unitsPerEm"]
        return table["sTypoAscender"] / unit, -table["sTypoDescender"] / unit, table["sTypoLineGap"] / unit

    def setting(self, text: str) -> Setting:
        """A line of text, set word by word."""
        if any(unicodedata.bidirectional(c) in SHAPED for c in text if ord(c) > 0x2ff):
            return self._shaped(text)
        words = [self._word(word) for word in text.split(" ")]
        if len(words) == 1:
            return words[0]
        gap, left, placed = self._glyph(" ").advance, 0.0, []
        for word in words:
            placed += [(glyph, left + x) for glyph, x in word.glyphs]
            left += word.width + gap
        return Setting(tuple(placed), left - gap)

    @lru_cache(MOST_WORDS)  # noqa: B019 - faces live as long as the process, see `face_of`
    def _word(self, word: str) -> Setting:
        placed, left, before = [], 0.0, ""
        for character in word:
            left += self._kern(before, character)
            placed.append((self._glyph(character), left))
            left += placed[-1][0].advance
            before = character
        return Setting(tuple(placed), left)

    def _kern(self, left: str, right: str) -> float:
        if (left, right) not in self._pairs:
            index = self._font.get_char_index
            self._size()
            self._pairs[left, right] = self._font.get_kerning(
                index(ord(left)), index(ord(right)), self._kerning) / 64 if left else 0.0
        return self._pairs[left, right]

    def _glyph(self, character: str) -> Glyph:
        if character not in self._glyphs:
            self._size()
            index = self._font.get_char_index(ord(character))  # 0, a box, where the font lacks it
            advance = self._font.load_glyph(index, flags=self._flags).linearHoriAdvance / 65536
            name = f"{self._font.postscript_name}-{index:x}"
            self._glyphs[character] = _glyph(name, *self._font.get_path(), advance)
        return self._glyphs[character]

    def _size(self) -> None:
        self._font.set_size(EM, 72)

    @lru_cache(MOST_WORDS)  # noqa: B019 - as above
    def _shaped(self, text: str) -> Setting:
        """A text of other scripts as one glyph, as matplotlib sets it."""
        import numpy as np
        from matplotlib.font_manager import FontProperties
        from matplotlib.textpath import text_to_path

        font = FontProperties(fname=self._path, size=EM)
        vertices, codes = text_to_path.get_text_path(font, text)
        width = text_to_path.get_text_width_height_descent(text, font, False)[0]
        name = f"{self._font.postscript_name}-text-{zlib.crc32(text.encode()):08x}"
        return Setting(((_glyph(name, np.reshape(vertices, (-1, 2)), np.array(codes, np.uint8), width), 0.0),), width)


def _glyph(name: str, vertices: Any, codes: Any, advance: float) -> Glyph:
    from matplotlib.path import Path

    heights = vertices[codes != Path.CLOSEPOLY][:, 1] if len(vertices) else ()
    return Glyph(name, vertices, codes, advance, min(heights, default=0.0), max(heights, default=0.0))


@cache
def face(path: str) -> Face:
    """The face of a font file."""
    return Face(path)


def face_of(font: FontProperties) -> Face:
    """The face that matplotlib finds for a font."""
    return _face_of(tuple(font.get_family()), font.get_style(), font.get_weight())


@cache
def _face_of(family: tuple[str, ...], slant: str, weight: str | int) -> Face:
    from matplotlib.font_manager import FontProperties, findfont

    return face(findfont(FontProperties(family=list(family), style=slant, weight=weight)))

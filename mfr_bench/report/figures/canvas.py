"""Draws a figure once, into a PNG and an SVG file alike."""

from __future__ import annotations

import io
import math
import struct
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.backend_bases import RendererBase
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.backends.backend_svg import RendererSVG
from matplotlib.colors import rgb2hex
from matplotlib.path import Path
from matplotlib.transforms import Affine2D, Bbox, TransformedPath

from . import seal
from .glyphs import EM, Setting, face_of
from .sheet import POINTS, small_print

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.backend_bases import GraphicsContextBase
    from matplotlib.figure import Figure
    from matplotlib.font_manager import FontProperties

INCH_M = 0.0254
PNG_RGB, PNG_METRES = 2, 1
LEVEL = 3  # of zlib. Figures take 11 ms, and 0.84 of Pillow's bytes, which tries five filters on each row in 19 ms
NEAR = 1e-6


class PngAndSvg(RendererBase):
    """Hands on what is drawn, in points, to matplotlib's renderers of SVG and, scaled to pixels, of images.

    What takes most of a figure's time is done once for both: layout, and text, which is drawn as outlines.
    """

    def __init__(self, figure: Figure, dpi: float, mark: str = ""):
        """A canvas of the figure's size. mark: a line of text that both files bear near their beginning."""
        super().__init__()
        width, height = figure.get_size_inches()
        self.width, self.height = width * POINTS, height * POINTS
        self._scale = dpi / POINTS
        self._to_pixels = Affine2D().scale(self._scale)
        self._dpi, self._mark = dpi, mark
        self._said, said_in = small_print(figure)
        self._said_rows = math.ceil(said_in * dpi)
        self._text = io.StringIO()
        metadata = {"Date": None, "Creator": None} | ({"Source": mark} if mark else {})
        self._svg = RendererSVG(self.width, self.height, self._text, image_dpi=dpi, metadata=metadata)
        self._image = RendererAgg(math.floor(width * dpi + NEAR), math.floor(height * dpi + NEAR), dpi)
        self._clips: dict[tuple[float, ...], Bbox] = {}
        self._named: set[str] = set()

    # --- what the files have ---------------------------------------------------------------------

    def svg(self) -> bytes:
        """The SVG file, when all is drawn."""
        self._svg.finalize()
        return seal.sealed_svg(self._text.getvalue().encode())

    def png(self) -> bytes:
        """The PNG file, without the transparency that no figure has; it has the small print as text, too."""
        pixels = np.asarray(self._image.buffer_rgba())
        height, width, _ = pixels.shape
        rows = np.zeros((height, 1 + 3 * width), np.uint8)  # before each row of pixels its filter: none
        rows[:, 1:] = pixels[:, :, :3].reshape(height, 3 * width)
        per_metre = round(self._dpi / INCH_M)
        return b"".join((
            seal.PNG_SIGNATURE, seal.chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, PNG_RGB, 0, 0, 0)),
            seal.chunk(b"pHYs", struct.pack(">2IB", per_metre, per_metre, PNG_METRES)),
            seal.chunk(b"tEXt", b"Source\0" + self._mark.encode()) if self._mark else b"",
            *self._small_print(),
            seal.chunk(b"IDAT", zlib.compress(rows, LEVEL)), seal.chunk(b"IEND", b"")))

    def _small_print(self) -> Iterator[bytes]:
        """Chunks with the small print, not compressed and of no language that is told, and the rows that show it."""
        if self._said:
            yield seal.chunk(b"iTXt", seal.SAID.encode() + b"\0" * 5 + self._said.encode())
            yield seal.chunk(b"tEXt", f"{seal.SAID_ROWS}\0{self._said_rows}".encode())

    # --- what is asked of a renderer -------------------------------------------------------------

    def get_canvas_width_height(self):
        return self.width, self.height

    def flipy(self):
        return True

    def get_image_magnification(self):
        return self._scale

    def option_image_nocomposite(self):
        return True

    def open_group(self, s, gid=None):
        self._svg.open_group(s, gid)

    def close_group(self, s):
        self._svg.close_group(s)

    def draw_path(self, gc, path, transform, rgbFace=None):
        self._svg.draw_path(gc, path, transform, rgbFace)
        self._image.draw_path(self._scaled(gc), path, self._pixels(transform), rgbFace)

    def draw_markers(self, gc, marker_path, marker_trans, path, trans, rgbFace=None):
        self._svg.draw_markers(gc, marker_path, marker_trans, path, trans, rgbFace)
        self._image.draw_markers(self._scaled(gc), marker_path, self._pixels(marker_trans), path, self._pixels(trans),
                                 rgbFace)

    def draw_path_collection(self, gc, master_transform, paths, all_transforms, offsets, offset_trans, *look, **more):
        self._svg.draw_path_collection(gc, master_transform, paths, all_transforms, offsets, offset_trans, *look,
                                       **more)
        self._image.draw_path_collection(self._scaled(gc), self._pixels(master_transform), paths, all_transforms,
                                         offsets, self._pixels(offset_trans), *look, **more)

    def draw_quad_mesh(self, gc, master_transform, width, height, coordinates, offsets, offset_trans, *look):
        self._svg.draw_quad_mesh(gc, master_transform, width, height, coordinates, offsets, offset_trans, *look)
        self._image.draw_quad_mesh(self._scaled(gc), self._pixels(master_transform), width, height, coordinates,
                                   offsets, self._pixels(offset_trans), *look)

    def draw_image(self, gc, x, y, im, transform=None):
        self._svg.draw_image(gc, x, y, im)
        self._image.draw_image(self._scaled(gc), x * self._scale, y * self._scale, im)

    # --- text ------------------------------------------------------------------------------------

    def _get_font_height_metrics(self, prop):
        """Ascent, descent and gap between lines, in points; without it, matplotlib 3.11 reads them for each text."""
        return tuple(height * prop.get_size_in_points() for height in face_of(prop).heights)

    def get_text_width_height_descent(self, s, prop, ismath):
        found, scale = face_of(prop).setting(s), prop.get_size_in_points() / EM
        return found.width * scale, (found.top - found.bottom) * scale, -found.bottom * scale

    def draw_text(self, gc, x, y, s, prop, angle, ismath=False, mtext=None):
        found = face_of(prop).setting(s)
        self._write(gc, x, y, found, prop, angle, s)
        self._paint(gc, x, y, found, prop, angle)

    def _write(self, gc: GraphicsContextBase, x: float, y: float, found: Setting, font: FontProperties, angle: float,
               text: str) -> None:
        """A glyph of an SVG file is defined once, and used wherever it stands."""
        writer, size = self._svg.writer, font.get_size_in_points() / EM
        turned = f" rotate({-angle:g})" if angle else ""
        *colour, alpha = gc.get_rgb()
        writer.start("g", style=f"fill: {rgb2hex(colour)}" + (f"; opacity: {alpha:g}" if alpha != 1 else ""),
                     transform=f"translate({x:.3f} {y:.3f}){turned} scale({size:g} {-size:g})")
        writer.comment(text)  # which also ends the tag that is open: what follows is written past the writer
        seen = {glyph.name: glyph for glyph, _ in found.glyphs if len(glyph.codes)}
        new = [f'<path id="{name}" d="{glyph.svg}"/>\n' for name, glyph in seen.items() if name not in self._named]
        self._named.update(seen)
        self._text.write("".join([*(["<defs>\n", *new, "</defs>\n"] if new else ()),
                                  *(f'<use xlink:href="#{glyph.name}" x="{left:.2f}"/>\n'
                                    for glyph, left in found.glyphs if glyph.name in seen)]))
        writer.end("g")

    def _paint(self, gc: GraphicsContextBase, x: float, y: float, found: Setting, font: FontProperties,
               angle: float) -> None:
        """Pixels of a text: its baseline lies between two rows or columns of them, as do those of its neighbours."""
        vertices, codes = found.outline
        if not len(codes):
            return
        scale = font.get_size_in_points() / EM * self._scale
        left, base = x * self._scale, self._image.height - y * self._scale
        if angle % 180 == 0:
            base = round(base)
        elif angle % 180 == 90:
            left = round(left)
        pen = self._image.new_gc()
        pen.copy_properties(self._scaled(gc))
        pen.set_linewidth(0)
        pen.set_snap(False)
        place = Affine2D().scale(scale).rotate_deg(angle).translate(left, base)
        self._image.draw_path(pen, Path(vertices, codes), place, gc.get_rgb())

    # --- from points to pixels -------------------------------------------------------------------

    def _pixels(self, transform: Any) -> Affine2D:
        matrix = transform.get_matrix().copy()
        matrix[:2] *= self._scale
        return Affine2D(matrix)

    def _scaled(self, gc: GraphicsContextBase) -> GraphicsContextBase:
        """The context with its clipping in pixels; widths of lines are in points for either renderer."""
        rectangle, (path, transform) = gc.get_clip_rectangle(), gc.get_clip_path()
        if rectangle is None and path is None:
            return gc
        scaled = self._image.new_gc()
        scaled.copy_properties(gc)
        if rectangle is not None:
            key = rectangle.extents
            scaled.set_clip_rectangle(self._clips.setdefault(tuple(key), Bbox.from_extents(*(key * self._scale))))
        if path is not None:
            scaled.set_clip_path(TransformedPath(path, self._pixels(transform)))
        return scaled

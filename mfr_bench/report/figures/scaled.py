"""Figures scaled as a whole, in each format: text, lines and gaps alike."""

from __future__ import annotations

import io
import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from ...errors import StoreError
from ...store import ResultFolder, write_file
from .. import data
from ..latex import escaped
from ..look import Look, laid_out
from .entry import build
from .files import FORMATS, figure_paths, undrawn
from .kind import NothingToDraw
from .sheet import styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.text import Text


def write_scaled(folder: ResultFolder, look: Look) -> list[Path]:
    """Write figures/<look>/<name>.<format> for each figure and format. Raises StoreError."""
    result, written = data.load(folder), []
    with laid_out(look), styled():
        for place, options in zip(figure_paths(result), result.figures, strict=True):
            for suffix in look.formats:
                path = place.parent / look.name / f"{place.stem}.{suffix}"
                try:
                    figure = build(result, options)
                except NothingToDraw as why:
                    path.unlink(missing_ok=True)
                    warnings.warn(undrawn(path.with_suffix(""), options, why), stacklevel=2)
                    continue
                path.parent.mkdir(parents=True, exist_ok=True)
                WRITERS[suffix](figure, look, path)
                written.append(path)
    return written


def _png(figure: Figure, look: Look, path: Path) -> None:
    content = io.BytesIO()
    figure.savefig(content, format="png", **{**FORMATS["png"], "dpi": look.dpi * look.scale})
    write_file(path, content.getvalue())


def _svg(figure: Figure, look: Look, path: Path) -> None:
    """Its viewBox stays as it is laid out; width and height say how large that is shown."""
    content = io.StringIO()
    figure.savefig(content, format="svg", **FORMATS["svg"])

    def scaled(side: re.Match[str]) -> str:
        return f'{side[1]}="{float(side[2]) * look.scale:g}pt"'

    shown = re.sub(r"<svg [^>]*>", lambda tag: re.sub(r'\b(width|height)="([\d.]+)pt"', scaled, tag[0]),
                   content.getvalue(), count=1)
    write_file(path, shown.encode())


def _pdf(figure: Figure, look: Look, path: Path) -> None:
    """The page has the final size; its content is scaled by the first operator. Text stays text, in TrueType."""
    import matplotlib as mpl
    from matplotlib.backends.backend_mixed import MixedModeRenderer
    from matplotlib.backends.backend_pdf import Op, PdfFile, RendererPdf

    content = io.BytesIO()
    width, height = figure.get_size_inches()
    dpi = look.dpi * look.scale  # of images within the figure
    with mpl.rc_context({"pdf.fonttype": 42}):
        file = PdfFile(content, metadata={"CreationDate": None, "Creator": None, "Producer": None})
        file.newPage(width * look.scale, height * look.scale)
        file.width, file.height = width, height  # to which lines are clipped, in the layout's units
        file.output(look.scale, 0, 0, look.scale, 0, 0, Op.concat_matrix)
        figure.dpi = 72  # the points of a PDF
        renderer = MixedModeRenderer(figure, width, height, dpi, RendererPdf(file, dpi, height, width))
        figure.draw(renderer)
        renderer.finalize()
        file.finalize()
        file.close()
    write_file(path, content.getvalue())


class _Turned:
    """A text turned by 90 degrees, with the alignment that TeX gives it before it is turned.

    matplotlib tells TeX where such a text begins: one that is wider or narrower in the document's font would end
    elsewhere, and run into what it stands under.
    """

    MODE = "anchor"

    def __init__(self, text: Text):
        self.get_unitless_position, self.get_transform = text.get_unitless_position, text.get_transform
        self._across, self._along = text.get_horizontalalignment(), text.get_verticalalignment()

    def get_rotation_mode(self) -> str:
        return self.MODE

    def get_horizontalalignment(self) -> str:
        return {"top": "right", "center": "center"}.get(self._along, "left")

    def get_verticalalignment(self) -> str:
        return {"left": "top", "right": "bottom"}.get(self._across, "center")


def _pgf(figure: Figure, look: Look, path: Path) -> None:
    """Write a file for \\input: texts are set in the document's font. Images within the figure are files next to it.

    matplotlib's own backend asks a LaTeX installation for the size of each text; here the figure's font tells it.
    """
    from matplotlib.backends import backend_pgf
    from matplotlib.textpath import text_to_path
    from matplotlib.transforms import Bbox, IdentityTransform

    width, height = figure.get_size_inches()
    paper = Bbox.from_extents(-width, -height, 2 * width, 2 * height).transformed(figure.dpi_scale_trans)

    class Renderer(backend_pgf.RendererPgf):
        """Measures texts by outlines, and escapes what LaTeX does not print."""

        def get_text_width_height_descent(self, s, prop, ismath):
            return tuple(size * self.dpi / 72 for size in text_to_path.get_text_width_height_descent(s, prop, False))

        def draw_path(self, gc, path, transform, rgbFace=None):
            drawn = transform.transform_path(path)
            if rgbFace is not None or gc.get_hatch():  # bars on a logarithmic axis begin far outside
                drawn = drawn.clip_to_bbox(paper)
            super().draw_path(gc, drawn, IdentityTransform(), rgbFace)

        def draw_text(self, gc, x, y, s, prop, angle, ismath=False, mtext=None):
            if mtext and angle == 90 and mtext.get_rotation_mode() != _Turned.MODE:
                mtext = _Turned(mtext)
            super().draw_text(gc, x, y, escaped(s), prop, angle, ismath, mtext)

    try:
        with open(path, "w", encoding="utf-8") as file:
            file.write("% Needs \\usepackage{pgf}.\n\\begingroup\\makeatletter\\begin{pgfpicture}%\n"
                       f"\\pgfpathrectangle{{\\pgfpointorigin}}{{\\pgfqpoint"
                       f"{{{width * look.scale:.6f}in}}{{{height * look.scale:.6f}in}}}}%\n"
                       "\\pgfusepath{use as bounding box, clip}%\n"
                       f"\\pgflowlevel{{\\pgftransformscale{{{look.scale:.6f}}}}}%\n")
            figure.draw(Renderer(figure, file))
            file.write("\\end{pgfpicture}\\makeatother\\endgroup%\n")
    except OSError as error:
        raise StoreError(f"{path}: cannot be written: {error.strerror}") from None


WRITERS = {"png": _png, "svg": _svg, "pdf": _pdf, "pgf": _pgf}

"""The look of figures, their width, size of text and file format: for a paper, for slides."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

from . import style

BASE_PT = 8.0  # the size of labels in which figures are laid out
LEAST_IN = 4.6  # narrowest layout, of labels of that size: panels and legends have room in it
FORMATS = ("png", "svg", "pdf", "pgf")


@dataclass(frozen=True)
class Look:
    """Width in inches, size of the labels in points (other texts keep their ratio to it), dots per inch, formats.

    A figure is laid out at `layout_in` inches with labels of BASE_PT, and scaled as a whole.
    """

    name: str
    width_in: float
    font_pt: float
    dpi: float
    formats: tuple[str, ...]

    @property
    def scale(self) -> float:
        return self.font_pt / BASE_PT

    @property
    def layout_in(self) -> float:
        return self.width_in / self.scale

    @property
    def largest_font_pt(self) -> float:
        """The largest labels that so wide a figure has room for."""
        return BASE_PT * self.width_in / LEAST_IN


STYLES: Mapping[str, Look] = {
    "paper": Look("paper", style.WIDTH_IN, BASE_PT, 600, ("pdf", "pgf", "png")),  # both columns of a page
    "slides": Look("slides", 12.0, 16.0, 200, ("png", "svg", "pdf")),  # on a slide of 13.33 by 7.5 inches
}


@contextmanager
def laid_out(look: Look) -> Iterator[None]:
    """Figures that are built meanwhile are as wide as the look's layout, all of them."""
    before = style.WIDTH_IN, style.NARROW_IN
    style.WIDTH_IN = style.NARROW_IN = look.layout_in
    try:
        yield
    finally:
        style.WIDTH_IN, style.NARROW_IN = before

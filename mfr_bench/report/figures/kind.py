"""The declaration of a kind of figure: the keys of its entry in a config, and what its x and y may be.

A kind is a file of `kinds/` with a `KIND` and a function `draw(result, options)`; its name is the file's. Configs are
checked against the declaration, so that this module and the files of `kinds/` load no matplotlib before they draw.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal


class NothingToDraw(Exception):  # noqa: N818 - no error: a figure without a value is not drawn
    """No cell has a value that the figure shows; the text says why."""


@dataclass(frozen=True)
class Key:
    """A key of a figure's entry in a config.

    takes: one text, several texts, true or false, or one of these words or numbers.
    names: whether the text is a swept key or a column that tells where a cell stands, or a parameter of a method.
    of: what several texts are.
    """

    name: str
    meaning: str
    takes: Literal["text", "texts", "flag"] | tuple[str | int, ...] = "text"
    default: Any = None
    names: Literal["", "column", "parameter"] = ""
    of: str = ""


@dataclass(frozen=True)
class Kind:
    """A kind of figure, as a config may ask for it.

    x, y: the names that these keys take; None for every swept key and column, and for every measure.
    other_y: values of y that are no measure.
    arrays: whether y names an array that each cell keeps, as measure.keep of the config must ask for.
    needs: keys that must be given, besides kind and x.
    """

    meaning: str
    keys: tuple[Key, ...] = ()
    x: tuple[str, ...] | None = None
    y: tuple[str, ...] | None = None
    other_y: tuple[str, ...] = ()
    arrays: bool = False
    needs: tuple[str, ...] = ()


COMMON = (
    Key("title", "stands above the figure, in place of the title of the config"),
    Key("methods", "only the methods of these labels", "texts", (), of="labels of methods"),
)
LOG = Key("log", "axes with a logarithmic scale", ("x", "y", "xy"))
LOG_BASE = Key("log_base", "of the ticks of a logarithmic scale", (2, 5, 10), 10)
X_LABEL = Key("x_label", "text of the x axis")
Y_LABEL = Key("y_label", "text of the y axis")
PANELS = Key("panels", "a panel for each of its values", names="column")
FLOOR = Key("floor", "the time of the floor as a dashed line", "flag", default=False)
SORTED = Key("sorted", "the bars of each group from the lowest to the highest", "flag", default=False)
PASSES = Key("passes", "the time of the first of these passes that a method has, instead of y", "texts", (),
             of="names of passes")
GAIN_OF = Key("gain_of", "what this parameter gains over its first value, instead of y", names="parameter")
PRINTED = Key("printed", "the paper's numbers of this quantity, as marks")

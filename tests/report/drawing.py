"""The helpers that tests of figures share: planted cells, the figure of them, and what is read from it."""

from __future__ import annotations

import pytest

from mfr_bench.report import data, figures
from mfr_bench.report.figures.kind import NothingToDraw
from mfr_bench.store.arrays import write_arrays

from . import planted
from .planted import cell

STACKED = {"kind": "stacked_passes", "x": "k", "y": "time_ms", "log": "y"}
LINES = {"kind": "lines", "x": "n", "y": "time_ms", "log": "xy", "log_base": 2}
KINDS = [STACKED, LINES | {"x": "k"}, {"kind": "bars", "x": "k", "y": "memory_mib", "log": "y"}]
MAPS = {"kind": "maps", "x": "k", "y": "error"}


def built(tmp_path, cells, options, **manifest):
    return figures.build(data.load(planted.folder(tmp_path, cells, [options], **manifest)), options)


def undrawn(*arguments, made=built, **manifest):
    """The reason why a figure is not drawn."""
    with pytest.raises(NothingToDraw) as why:
        made(*arguments, **manifest)
    return str(why.value)


def bars_of(axes):
    """Bottom, height and label of each drawn piece of a bar, in drawing order."""
    return [(p.get_y(), p.get_height(), p.get_label()) for p in axes.patches
            if ": " in p.get_label() and not p.get_label().startswith("hatch")]


def texts_of(axes):
    return [text.get_text() for text in axes.texts]


def all_texts(figure):
    from matplotlib.text import Text
    return [t.get_text() for t in figure.findobj(Text) if t.get_text()]


def drawn_texts(figure):
    """Texts that are seen: of ticks only those within the limits."""
    for axes in figure.axes:
        yield from (*axes.texts, axes.xaxis.label, axes.yaxis.label)
        for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            yield from (t.label1 for t in axis.get_major_ticks() if low <= t.get_loc() <= high)
    yield from figure.texts
    yield from (text for legend in figure.legends for text in legend.get_texts())


def two_methods(**parts):
    return [cell("kb-ps", "KB-PS", 10.0, {"clear": 1.0, "store": 6.0, "resolve": 2.5}, params={"k": k}, point={"k": k})
            for k in (4, 8)] + [
        cell("kplus-sb", "K⁺B-SB", 5.0, {"clear": 0.5, "count": 1.5, "store": 2.0}, params={"k": k}, point={"k": k},
             **parts) for k in (4, 8)]


FRAMES = [{"frame": 0, "fragments": 60, "covered_pixels": 30, "max_fragments": 2, "chosen_k": None, "kept": 60,
           "histogram": [0, 10, 20]}]
WORK = {"store": {"stored": 1, "invocations": 1, "rasterized": True}}


def keep_arrays(folder, **arrays):
    """Let each cell of the folder keep these arrays, by name."""
    for found in folder.cells():
        write_arrays(folder, found["key"], arrays)
    return folder


def curves(axes):
    return {c.get_label(): c.lines[0] for c in axes.containers}


def mapped(tmp_path, options, arrays, **more):
    """A folder of one cell for each entry of `arrays`, which maps (label, k) to arrays; the figure of it."""
    cells = [cell("kb", label, 4.0, params={"k": k}, point={"k": k}, **more) for label, k in arrays]
    folder = planted.folder(tmp_path, cells, [options])
    for record, kept in zip(cells, arrays.values(), strict=True):
        write_arrays(folder, record["key"], kept)
    return figures.build(data.load(folder), options)

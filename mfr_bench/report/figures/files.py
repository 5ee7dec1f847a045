"""Figures as files."""

from __future__ import annotations

import gc
import io
import json
import os
import re
import warnings
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...environment import usable_cores
from ...parallel import in_processes
from ...store import ResultFolder, write_file
from .. import data, style
from ..data import Result
from .build import build
from .series import Options
from .sheet import lacking_glyphs, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS: Mapping[str, Mapping[str, Any]] = {
    "png": {"dpi": style.DPI, "metadata": {"Software": None}, "pil_kwargs": {"compress_level": 4}},
    "svg": {"metadata": {"Date": None, "Creator": None}},
}


DRAWS = ("matplotlib.figure", "matplotlib.backends.backend_agg", "matplotlib.backends.backend_svg")  # long to import


def write_figures(folder: ResultFolder, processes: int = 1) -> list[Path]:
    """Write figures/<name>.png and .svg, numbered where there are several. Raises StoreError.

    Files of this experiment's name that an earlier config left there are removed. With 2 `processes`
    a forked child draws every other figure; not where the process holds a GL context.
    """
    result, target = data.load(folder), folder.path / "figures"
    written = _draw_all(result, target, processes)
    _remove_others(target, {path.stem for path in written}, file_name(result.name))
    return written


def _remove_others(target: Path, stems: Collection[str], name: str) -> None:
    """Delete the figures of this name, numbered or not, that are none of `stems`."""
    mine = re.compile(rf"{re.escape(name)}(-\d+)?")
    for path in target.glob("*.*"):
        if path.suffix[1:] in FORMATS and mine.fullmatch(path.stem) and path.stem not in stems:
            path.unlink(missing_ok=True)


def write_all(folders: Sequence[ResultFolder],
              processes: int | None = None) -> Iterator[tuple[list[Path], list[str]]]:
    """Writes the figures of each folder; returns their files, and what could not be used. Raises StoreError.

    Forked processes draw a folder each, as many at a time as there are cores; not where the process holds a GL context.
    """
    count = min(processes or usable_cores() or 1, len(folders))
    if count < 2:
        yield from ((write_figures(folder, processes=2), folder.damaged) for folder in folders)
        return
    yield from in_processes(_written, folders, count, DRAWS)


def _written(folder: ResultFolder) -> tuple[list[Path], list[str]]:
    paths = write_figures(folder)
    return paths, folder.damaged


MOST_PANELS = 24  # devices of which each has a panel
FEW_PANELS = 6  # of more: the fastest, the slowest and some between them


def write_panels(folders: Sequence[ResultFolder], target: Path) -> list[Path]:
    """Write the figures of one experiment in several folders, a panel or a series for each device. Raises StoreError.

    The folders stand from that of the fastest device to that of the slowest. Of more than MOST_PANELS, FEW_PANELS at
    even steps are drawn, and the figures say so.
    """
    chosen = folders if len(folders) <= MOST_PANELS else evenly(folders, FEW_PANELS)
    result = data.join([data.load(folder) for folder in chosen])
    if len(chosen) < len(folders):
        said = f"{len(chosen)} of {len(folders)} devices: the fastest, the slowest, and at even steps between them."
        source = dict(result.manifest.get("source") or {})
        source["readings"] = [said, *(source.get("readings") or ())]
        result = replace(result, manifest={**result.manifest, "source": source})
    return _draw_all(_by_device(result), target, 1)


def evenly(order: Sequence[Any], most: int) -> list[Any]:
    """A part of a sequence, at most so long: at even steps, its ends among them."""
    if len(order) <= most:
        return list(order)
    return [order[round(i * (len(order) - 1) / (most - 1))] for i in range(most)]


def figure_paths(result: Result) -> list[Path]:
    """The path of the PNG file of each of the result's figures, in their order, whether or not it is there."""
    return [stem.with_name(f"{stem.name}.png") for stem in _stems(result, result.folder.path / "figures")]


def _stems(result: Result, target: Path) -> list[Path]:
    """The files of the result's figures without their endings: numbered where there are several."""
    name, several = file_name(result.name), len(result.figures) > 1
    return [target / (f"{name}-{i}" if several else name) for i in range(1, len(result.figures) + 1)]


def file_name(experiment: str) -> str:
    """An experiment's name as that of a file."""
    return re.sub(r"[^\w.-]+", "-", experiment).strip("-.") or "figure"


def _by_device(result: Result) -> Result:
    """Figures without panels of their own get one for each device."""
    panelled = [options if options.get("panels") else {**options, "panels": "device"} for options in result.figures]
    return replace(result, manifest={**result.manifest, "figures": panelled})


def _draw_all(result: Result, target: Path, processes: int) -> list[Path]:
    if not result.figures:
        return []  # before matplotlib is imported
    several = len(result.figures) > 1
    if any(options.get("kind") == "maps" for options in result.figures):
        for point in result.points:  # read here, to report unreadable files; a forked child's warnings are lost
            _ = point.arrays
    tasks = list(zip(_stems(result, target), result.figures, strict=True))
    with _uncollected(), _boxes_told(result):
        if processes > 1 and several:
            _write_shared(result, tasks)
        else:
            _write(result, tasks)
    return [path.with_name(f"{path.name}.{suffix}") for path, _ in tasks for suffix in FORMATS]


def _write(result: Result, tasks: Iterable[tuple[Path, Options]]) -> None:
    for path, options in tasks:
        for suffix, content in render(build(result, options)).items():
            write_file(path.with_name(f"{path.name}.{suffix}"), content)


def _write_shared(result: Result, tasks: Sequence[tuple[Path, Options]]) -> None:
    from matplotlib.backends import backend_agg, backend_svg  # noqa: F401  loaded once, for both

    child = os.fork()
    if child == 0:
        try:
            _write(result, tasks[1::2])
        except BaseException:  # noqa: BLE001 - a forked child must never return into its parent's code
            os._exit(1)
        os._exit(0)
    _write(result, tasks[::2])
    if os.waitpid(child, 0)[1]:
        _write(result, tasks[1::2])  # raises the child's error here


@contextmanager
def _boxes_told(result: Result):
    """Warn once of the characters that the figures' font lacks, instead of each time that one is drawn."""
    texts = [str(result.manifest.get("title")), *(point.label for point in result.points),
             json.dumps(result.figures, ensure_ascii=False)]
    if lacking := lacking_glyphs("".join(texts)):
        warnings.warn(f"{result.name}: the font of the figures lacks {' '.join(lacking)}; boxes stand for them",
                      stacklevel=2)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        yield


@contextmanager
def _uncollected():
    """Suspend garbage collection: it takes a fifth of the time, and everything lives to the end anyway."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def render(figure: Figure) -> dict[str, bytes]:
    """The figure as file contents by suffix. Nothing in them depends on when or where they were made."""
    contents = {}
    with styled():
        for suffix, options in FORMATS.items():
            file = io.BytesIO()
            figure.savefig(file, format=suffix, **options)
            contents[suffix] = file.getvalue()
    return contents

"""Figures as files."""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...environment import usable_cores
from ...parallel import in_processes, uncollected
from ...store import ResultFolder, remove_parts, write_file
from .. import data, style
from ..data import Result
from . import inputs
from .entry import build
from .kind import NothingToDraw
from .series import Options
from .sheet import POINTS, lacking_glyphs, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS: Mapping[str, Mapping[str, Any]] = {
    "png": {"dpi": style.DPI, "metadata": {"Software": None}, "pil_kwargs": {"compress_level": 3}},
    "svg": {"metadata": {"Date": None, "Creator": None}},
}


DRAWS = ("matplotlib.figure", f"{__package__}.canvas")  # long to import


@dataclass(frozen=True)
class Drawn:
    """The files of a folder's figures, how many figures of them were up to date, and lines on what went wrong.

    damaged: files that could not be used. empty: figures that are not drawn, since no cell has a value for them.
    """

    paths: list[Path]
    kept: int
    damaged: list[str]
    empty: list[str]


def prepare_to_draw() -> None:
    """Import what draws: as long as a figure takes, for who has time for it before there is anything to draw."""
    for name in DRAWS:
        import_module(name)


def write_figures(folder: ResultFolder, processes: int | None = 1, force: bool = False) -> list[Path]:
    """Write figures/<name>.png and .svg, numbered where there are several. Raises StoreError.

    A figure whose files bear the digest of all that it is drawn from is left as it is, unless `force` says otherwise;
    see `inputs`. Files of this experiment's name that an earlier config left there are removed. A figure without a
    value is not drawn; a warning says so. With more `processes` these share the figures, see `in_processes`.
    """
    remove_parts(folder.path / "figures")
    drawn = _drawn(folder, processes, force)
    for line in drawn.empty:
        warnings.warn(line, stacklevel=2)
    return drawn.paths


def _drawn(folder: ResultFolder, processes: int | None = 1, force: bool = False) -> Drawn:
    planned = Result(folder, folder.manifest(), ())
    stems, target = _stems(planned), folder.path / "figures"
    marks = inputs.marks(folder, stems) if stems else []
    due = [force or not _current(stem, mark) for stem, mark in zip(stems, marks, strict=True)]
    empty: list[str] = []
    if any(due) or not due:  # without figures too: what could not be used is told
        result = data.load(folder)
        tasks = zip(stems, result.figures, marks, strict=True)
        empty = _draw_all(result, [task for task, wanted in zip(tasks, due, strict=True) if wanted], processes)
    _remove_others(target, {stem.name for stem in stems}, file_name(planned.name))
    return Drawn(_there(stems), due.count(False), folder.damaged, empty)


def _current(stem: Path, mark: str) -> bool:
    return all(inputs.current(path, mark) for path in _files([stem]))


def _files(stems: Iterable[Path]) -> list[Path]:
    return [stem.with_name(f"{stem.name}.{suffix}") for stem in stems for suffix in FORMATS]


def _there(stems: Iterable[Path]) -> list[Path]:
    """The files of those figures that are drawn."""
    return [path for path in _files(stems) if path.is_file()]


def _remove_others(target: Path, stems: Collection[str], name: str) -> None:
    """Delete the figures of this name, numbered or not, that are none of `stems`."""
    mine = re.compile(rf"{re.escape(name)}(-\d+)?")
    for path in target.glob("*.*"):
        if path.suffix[1:] in FORMATS and mine.fullmatch(path.stem) and path.stem not in stems:
            path.unlink(missing_ok=True)


def write_all(folders: Sequence[ResultFolder], processes: int | None = None, force: bool = False) -> Iterator[Drawn]:
    """Write the figures of each folder that are not up to date, all with `force`; see `write_figures`.

    Other processes draw a folder each, as many at a time as there are cores, those with the most cells first. Where
    none has a file without a mark, what is up to date is found out here.
    """
    for folder in folders:
        remove_parts(folder.path / "figures")
    count = min(processes or usable_cores() or 1, len(folders))
    known = [None if force or not _marked(folder) else _if_current(folder) for folder in folders]
    due = sorted((i for i, found in enumerate(known) if found is None), key=lambda i: -_size(folders[i]))
    if min(count, len(due)) < 2:
        yield from (found or _drawn(folder, processes, force) for found, folder in zip(known, folders, strict=True))
        return
    drawn = in_processes(partial(_drawn, force=force), [folders[i] for i in due], count, DRAWS)
    at = 0
    for i, found in zip(due, drawn, strict=True):
        known[i] = found
        while at < len(known) and (found := known[at]):
            yield found
            at += 1
    yield from filter(None, known[at:])


def _marked(folder: ResultFolder) -> bool:
    """Whether each figure's files bear a mark, of whatever inputs."""
    return all(inputs.mark_of(path) for path in _files(_stems(Result(folder, folder.manifest(), ()))))


def _if_current(folder: ResultFolder) -> Drawn | None:
    """The figures of a folder, where none is due."""
    stems = _stems(Result(folder, folder.manifest(), ()))
    if stems and all(map(_current, stems, inputs.marks(folder, stems))):
        return Drawn(_files(stems), len(stems), folder.damaged, [])
    return None


def _size(folder: ResultFolder) -> int:
    manifest = folder.manifest()
    return len(manifest.get("cells") or ()) * len(manifest.get("figures") or ())


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
    joined = _by_device(result)
    stems = _stems(joined, target)
    tasks = [(stem, options, "") for stem, options in zip(stems, joined.figures, strict=True)]
    for line in _draw_all(joined, tasks, 1):
        warnings.warn(line, stacklevel=2)
    return _there(stems)


def evenly(order: Sequence[Any], most: int) -> list[Any]:
    """A part of a sequence, at most so long: at even steps, its ends among them."""
    if len(order) <= most:
        return list(order)
    return [order[round(i * (len(order) - 1) / (most - 1))] for i in range(most)]


def figure_paths(result: Result) -> list[Path]:
    """The path of the PNG file of each of the result's figures, in their order, whether or not it is there."""
    return [stem.with_name(f"{stem.name}.png") for stem in _stems(result)]


def _stems(result: Result, target: Path | None = None) -> list[Path]:
    """The files of the result's figures without their endings: numbered where there are several.

    target: their folder, by default the one that belongs to the result.
    """
    name, several = file_name(result.name), len(result.figures) > 1
    target = target or result.folder.path / "figures"
    return [target / (f"{name}-{i}" if several else name) for i in range(1, len(result.figures) + 1)]


def file_name(experiment: str) -> str:
    """An experiment's name as that of a file."""
    return re.sub(r"[^\w.-]+", "-", experiment).strip("-.") or "figure"


def _by_device(result: Result) -> Result:
    """Figures without panels of their own get one for each device."""
    panelled = [options if options.get("panels") else {**options, "panels": "device"} for options in result.figures]
    return replace(result, manifest={**result.manifest, "figures": panelled})


Task = tuple[Path, Options, str]  # a figure's files without their endings, its entry in the config, and its mark


def _draw_all(result: Result, tasks: Sequence[Task], processes: int | None) -> list[str]:
    """Draw figures; a line for each that no cell has a value for."""
    if not tasks:
        return []  # before matplotlib is imported
    if any(options.get("kind") == "maps" for _, options, _ in tasks):
        for point in result.points:  # read here, to report unreadable files, which another process would not
            _ = point.arrays
    with uncollected():  # collecting takes a fifth of the time, and everything lives to the end anyway
        unmarked = result.folder.damaged or _boxes_told(result)
        tasks = [(stem, options, "" if unmarked else mark) for stem, options, mark in tasks]
        return list(filter(None, in_processes(partial(_write, result), tasks, processes, DRAWS)))


def _write(result: Result, task: Task) -> str:
    """Write the files of a figure; where there is nothing to draw, remove them, and say why."""
    stem, options, mark = task
    try:
        figure = build(result, options)
    except NothingToDraw as why:
        for path in _files([stem]):
            path.unlink(missing_ok=True)
        return undrawn(stem, options, why)
    for suffix, content in render(figure, mark).items():
        write_file(stem.with_name(f"{stem.name}.{suffix}"), content)
    return ""


def undrawn(stem: Path, options: Options, why: NothingToDraw) -> str:
    """The line on a figure that is not drawn."""
    return f"{stem}: not drawn ({options['kind']} of {options.get('y') or 'time_ms'}): {why}"


def _boxes_told(result: Result) -> bool:
    """Warn of the characters that the figures' font lacks; whether there are any."""
    texts = [str(result.manifest.get("title")), *(point.label for point in result.points),
             json.dumps(result.figures, ensure_ascii=False)]
    if lacking := lacking_glyphs("".join(texts)):
        warnings.warn(f"{result.name}: the font of the figures lacks {' '.join(lacking)}; boxes stand for them",
                      stacklevel=2)
    return bool(lacking)


def render(figure: Figure, mark: str = "") -> dict[str, bytes]:
    """The figure as file contents by suffix, which bear the mark of its inputs, see `inputs`.

    Nothing in them depends on when or where they were made. The figure is laid out and drawn once.
    """
    from .canvas import PngAndSvg

    figure.dpi = POINTS
    with styled():
        both = PngAndSvg(figure, style.DPI, mark)
        figure.draw(both)
        return {"png": both.png(), "svg": both.svg()}

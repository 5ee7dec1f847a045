"""The content of the page, as plain data for its template: nothing here knows HTML."""

from __future__ import annotations

import json
import re
import shlex
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..config.settings import Measure
from ..report import data
from ..report.data import Point, Result
from ..report.tables import noise_text
from ..store.rows import package_text
from .pictures import figure_picture, kept_images, kept_picture

if TYPE_CHECKING:
    import numpy as np


@dataclass(frozen=True)
class Measured:
    """A column of the table of cells: its heading, the measure, and its meaning for a tooltip."""

    name: str
    heading: str
    meaning: str


FASTEST = "fastest_ratio"  # a ratio to another cell, which no cell has by itself
MEASURED = (
    Measured("time_ms", "time (ms)", "median of whole frames, with its 95 % interval"),
    Measured("floor_ratio", "× floor", "time over that of the same geometry with plain alpha blending"),
    Measured(FASTEST, "× fastest", "time over that of the fastest method that shows every fragment of the scene"),
    Measured("memory_mib", "memory (MiB)", "objects that the method allocated"),
    Measured("max_abs_error", "error", "largest channel error against the promised image"),
    Measured("rmse", "RMSE", "root mean square error against the image of all fragments"),
    Measured("flip", "FLIP", "mean FLIP error against the image of all fragments"),
    Measured("hit_ratio", "kept", "fragments kept / generated"),
    Measured("samples", "samples", "timed frames"),
)
SCENE = {"size": "viewport", "kind": "scene", "layout": "layout", "order": "order", "alpha": "opacity", "seed": "seed",
         "pixel_density": "pixel density p_d", "depth_complexity": "depth complexity n",
         "fragment_probability": "fragment probability f_p"}
ENVIRONMENT = ("gpu", "vendor", "gl", "mesa", "cpu", "cores", "kernel")  # no host, no user, no path
VERSIONS = ("mfr-bench", "python", "moderngl", "glcontext", "numpy", "flip-evaluator")
ANYWHERE = re.compile(r"(?<![\w.])(?:/[\w.+-]+){2,}/?|[A-Za-z]:\\\S+")  # an absolute path


@dataclass(frozen=True)
class Value:
    """A field of a row: the text shown, and what it is sorted and drawn by."""

    text: str
    raw: float | str | None = None
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class Line:
    """A row of the table of cells."""

    label: str
    method: str
    device: str
    status: str
    reason: str
    places: tuple[Value, ...]
    measures: tuple[Value, ...]


@dataclass(frozen=True)
class Picture:
    """A figure or a kept image. said: what the small print of a figure says, which its picture leaves out."""

    name: str
    uri: str
    width: int
    height: int
    said: tuple[str, ...] = ()
    x: str = ""
    y: str = ""


@dataclass(frozen=True)
class Experiment:
    """All of one result folder."""

    anchor: str
    name: str
    title: str
    source: str
    provenance: str
    setting: tuple[tuple[str, str], ...]
    counts: tuple[tuple[str, int], ...]
    axes: tuple[str, ...]
    devices: tuple[str, ...]
    lines: tuple[Line, ...]
    figures: tuple[Picture, ...]
    images: tuple[Picture, ...]
    environment: tuple[tuple[str, str], ...]
    reproduce: str
    lacking: str
    unsteady: str


def without_paths(text: Any) -> str:
    """The text with absolute paths replaced, since they reveal users and machines."""
    return ANYWHERE.sub("(path)", " ".join(str(text).split()))


def experiment(result: Result, anchor: str, figures: Sequence[Path]) -> Experiment:
    """The content of the page about a result. figures: the PNG files of its figures, in their order."""
    axes = tuple(axis for axis in result.axes if data.bare(axis) != "device")
    ratios = to_the_fastest(result.points)
    lines = tuple(_line(p, axes, ratios.get(id(p))) for p in result.points)
    return Experiment(
        anchor=anchor, name=result.name, title=str(result.manifest.get("title") or result.name),
        source=_source(result), provenance=without_paths(result.provenance), setting=_setting(result),
        counts=tuple(sorted(Counter(p.sign for p in result.points).items(), key=lambda item: (item[0] != "ok", item))),
        axes=tuple(data.short(axis) for axis in axes),
        devices=tuple(dict.fromkeys(line.device for line in lines)), lines=lines,
        figures=tuple(_figure(path, options) for path, options in zip(figures, result.figures, strict=False)
                      if path.is_file()),
        images=_images(result.points), environment=_environment(result.manifest),
        reproduce=command_of(result.manifest, result.name), lacking=result.lacking + result.why_unmeasured,
        unsteady=without_paths(result.unsteady))


def _source(result: Result) -> str:
    source = result.manifest.get("source") or {}
    return " ".join(str(part) for part in (source.get("paper"), data.figure_of(source)) if part)


def _setting(result: Result) -> tuple[tuple[str, str], ...]:
    """The scene and the sweeps in words that need no config."""
    scene = result.manifest.get("scene") or (result.points[0].cell["scene"] if result.points else {})
    found = [(words, data.plain(_tuple(scene[name]))) for name, words in SCENE.items() if scene.get(name) is not None]
    profile = result.manifest.get("profile")
    found += [("profile", str(profile))] if profile else []
    for kind in ("sweep", "zip"):
        found += [(data.short(name), ", ".join(data.plain(_tuple(v)) for v in values))
                  for name, values in (result.manifest.get(kind) or {}).items() if isinstance(values, list)]
    return tuple((name, without_paths(value)) for name, value in found)


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def to_the_fastest(points: Iterable[Point]) -> dict[int, float]:
    """Ratios of times, by the identity of a point, among those of a scene and device in which every fragment shows."""
    scenes: dict[str, list[Point]] = {}
    for p in points:
        if p.shows_all and not data.is_floor(p):
            scenes.setdefault(json.dumps([p.cell["scene"], p.row["device"]], sort_keys=True), []).append(p)
    found = {}
    for alike in scenes.values():
        fastest = min(alike, key=lambda p: p.row["time_ms"])
        found |= {id(p): 1.0 if p is fastest else p.over(fastest)[1] for p in alike if alike[1:]}
    return {key: ratio for key, ratio in found.items() if ratio is not None}


def _line(point: Point, axes: Iterable[str], to_fastest: float | None) -> Line:
    places = tuple(Value("" if (v := point.at(axis)) is None else data.plain(v), _raw(v)) for axis in axes)
    return Line(point.label, point.method, str(point.row.get("device") or ""), point.sign,
                without_paths(point.row.get("reason") or ""), places,
                tuple(_ratio(to_fastest) if column.name == FASTEST else _measure(point, column.name)
                      for column in MEASURED))


def _ratio(value: float | None) -> Value:
    return Value("") if value is None else Value(data.number(value), value)


def _raw(value: Any) -> float | str | None:
    return value if value is None or isinstance(value, (int, float)) else data.plain(value)


def _measure(point: Point, name: str) -> Value:
    low, middle, high = point.measure(name)
    if middle is None:
        return Value("")
    text = data.number(middle)
    if low is not None and high is not None and name == "time_ms":
        text += f" ({data.number(low)}–{data.number(high)})"
    return Value(text, middle, low, high)


def _figure(path: Path, options: Mapping[str, Any]) -> Picture:
    uri, width, height, said = figure_picture(path)
    y = str(options.get("y") or "time_ms")
    return Picture(path.stem, uri, width, height, tuple(map(without_paths, said)),
                   data.short(str(options.get("x") or "")), y)


def _images(points: Iterable[Point]) -> tuple[Picture, ...]:
    """The kept images, each once: equal ones, such as those of all exact methods, share a picture and its caption."""
    found: dict[tuple[tuple[int, ...], bytes], tuple[np.ndarray, list[str]]] = {}
    for point in points:
        image = kept_images(point.arrays)
        if image is not None:
            where = ", ".join(f"{data.short(k)} {data.plain(_tuple(v))}" for k, v in point.cell["point"].items())
            _, names = found.setdefault((image.shape, image.tobytes()), (image, []))
            names.append(": ".join(filter(None, (point.label, where))))
    return tuple(Picture("; ".join(names), *kept_picture(image)) for image, names in found.values())


def _environment(manifest: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    held, versions = manifest.get("environment") or {}, manifest.get("versions") or {}
    revision = (held.get("revision") or {}) if isinstance(held, Mapping) else {}
    found = [(name, held.get(name)) for name in ENVIRONMENT] + [(name, versions.get(name)) for name in VERSIONS]
    found += [("commit", f"{revision['commit'][:12]}{' with changes' if revision.get('dirty') else ''}")
              if isinstance(revision.get("commit"), str) else ("commit", None),
              ("timer", manifest.get("timer")), ("measured", manifest.get("started")),
              ("noise floor", noise_text(manifest["noise_floor_rel"])
               if isinstance(manifest.get("noise_floor_rel"), (int, float)) else None)]
    found += [("package", package_text(each)) for each in manifest.get("packages") or ()]
    return tuple((name, without_paths(value)) for name, value in found if value is not None)


def command_of(manifest: Mapping[str, Any], name: str) -> str:
    """The command that measures the experiment again."""
    scene = manifest.get("scene") or {}
    config = Path(str(manifest.get("config") or name)).stem
    named = _own_scene(scene, config, name)
    words = ["mfr-bench", "run", *named, *_memory(manifest.get("measure") or {}, named != [config])]
    if manifest.get("profile"):
        words += ["--profile", str(manifest["profile"])]
    settings = manifest.get("settings")
    words += [without_paths(word) for word in settings] if isinstance(settings, list) else []
    return shlex.join(words)


def _own_scene(scene: Mapping[str, Any], config: str, name: str) -> list[str]:
    """The words that name what ran: the config, or the file that an option put in the place of the config's scene."""
    option = {"mesh": "--mesh", "fragments": "--fragments"}.get(str(scene.get("kind")))
    if option is None or config == name or not scene.get("file"):
        return [config]
    size = ["--size", "x".join(str(pixels) for pixels in scene["size"])] if option == "--mesh" else []
    return [option, Path(str(scene["file"])).name, *size]


def _memory(measure: Mapping[str, Any], own: bool) -> list[str]:
    """The budget of memory that was given beside a scene of one's own, if any."""
    budget_mb = measure.get("memory_budget_mb")
    given = own and isinstance(budget_mb, (int, float)) and budget_mb != Measure.memory_budget_mb
    return ["--memory-mb", f"{budget_mb:g}"] if given else []

"""The points of a result folder: their axes, and what tells points of one label apart."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import PurePath
from typing import Any

from ...store import ResultFolder
from .point import Point
from .words import bare, figure_of, heading, percent, plain

SPELT_OUT = {  # symbols, as headings and axes have them
    "depth_complexity": "depth complexity n = {} ({})",
    "pixel_density": "pixel density p_d = {} (covered pixels / all)",
    "fragment_probability": "fragment probability f_p = {} (share that is not discarded)"}
KEPT = "Methods: k = {} (fragments kept per pixel)."
ALL_SHADED = 1.0  # the fragment probability of every scene that no generator of fragments makes
EVERY, MOST = "fragments per covered pixel", "most fragments of a pixel"
N_COUNTS = {"mixed": MOST, "random": "mean fragments per pixel of the block"}  # of quads, by layout
MOST_OF = ("hairball", "needles", "temple")
SCENE_WORDS = {"kind": "", "layout": "layout ", "order": "order ", "alpha": "opacity ",
               "effect": "effect "}


@dataclass(frozen=True)
class Result:
    """Everything that is drawn or tabulated from one folder."""

    folder: ResultFolder
    manifest: Mapping[str, Any]
    points: tuple[Point, ...]
    left_out: int = 0  # rows of the folder that its config does not have

    @property
    def name(self) -> str:
        return str(self.manifest.get("name") or self.folder.path.name)

    @property
    def figures(self) -> list[Mapping[str, Any]]:
        """The config's figures, as given there."""
        return [figure for figure in self.manifest.get("figures") or [] if isinstance(figure, Mapping)]

    @property
    def provenance(self) -> str:
        """One line: the paper, the device with its driver, the timer, the date, the program's version."""
        manifest = self.manifest
        source, device = manifest.get("source") or {}, manifest.get("device") or {}
        device = device if isinstance(device, Mapping) else {"renderer": device}
        paper = ", ".join(str(v) for v in (source.get("paper"), figure_of(source)) if v)
        version = (manifest.get("versions") or {}).get("mfr-bench")
        stand_in = source.get("stand_in")
        parts = [paper and f"after {paper}", stand_in and f"scene: {stand_in}",
                 device.get("renderer"), device.get("version"),
                 manifest.get("timer") and f"timer: {manifest['timer']}", self.dates,
                 version and f"mfr-bench {version}"]
        return " · ".join(str(part) for part in parts if part)

    @property
    def scene(self) -> str:
        """The line of `scene_of` for all points."""
        return self.scene_of(self.points)

    def scene_of(self, points: Sequence[Point]) -> str:
        """One line: viewport, scene and profile, with the symbols of the headings spelt out; then k, a key of methods.

        Empty without points.
        """
        profile = self.manifest.get("profile")
        said, kept = scene_words(points), _values(points, "k")
        scene = f"Scene: {said}{f'; profile {profile}' if profile else ''}." if said else ""
        return " ".join(filter(None, (scene, KEPT.format(_range(kept)) if kept else "")))

    @property
    def readings(self) -> str:
        """One line: how the experiment's config reads what the paper leaves open."""
        return " ".join(map(str, (self.manifest.get("source") or {}).get("readings") or ()))

    @property
    def dates(self) -> str:
        """The days on which the measuring began."""
        return "; ".join(part[:10] for part in str(self.manifest.get("started") or "").split("; "))

    @property
    def unsteady(self) -> str:
        """What the device or its timer did otherwise at the end of the run than at its start; empty where nothing."""
        return str(self.manifest.get("calibration_drift") or "")

    @property
    def unmeasured(self) -> int:
        """Planned cells without a record: the run was interrupted, or its file was damaged."""
        keys = {p.cell["key"] for p in self.points}
        return sum(key not in keys for key in self.manifest.get("cells", []))

    @property
    def why_unmeasured(self) -> str:
        """The words behind the count of planned cells without a record where the time budget is why; else empty."""
        left = sum((self.manifest.get("left_out") or {}).values())
        refused = self.manifest.get("refused") or 0
        if not left or self.unmeasured > left + refused:
            return ""
        others = f"; {refused:,} of them cannot be measured here at all" if refused else ""
        return f", left out for the time budget{others}"

    @property
    def lacking(self) -> str:
        """One line on what is not here: planned cells without a record, rows of no config, files not used."""
        files = len(self.folder.damaged)
        parts = [without_record(self.unmeasured) if self.unmeasured else "", self.foreign,
                 f"{files} {'file' if files == 1 else 'files'} could not be used" if files else ""]
        return "; ".join(part for part in parts if part)

    @property
    def foreign(self) -> str:
        """One line on rows that stand in the folder and not in its config; they are in results.csv alone."""
        rows = "1 row" if self.left_out == 1 else f"{self.left_out} rows"
        return f"{rows} of the folder left out: not of the config that ran last" if self.left_out else ""

    @property
    def labels(self) -> list[str]:
        """Series in the config's order."""
        return list(dict.fromkeys(p.label for p in self.points))

    @cached_property
    def axes(self) -> list[str]:
        """Keys with more than one value here: swept ones in the config's order, then the scene's, then the device.

        A scene may differ without being swept, as with r, which gives n = r k. Its keys that a method names a parameter
        alike are dotted.
        """
        swept = [*(self.manifest.get("sweep") or {}), *(k for p in self.points for k in p.cell["point"])]
        names = [*swept, *(_of_scene(k, p) for p in self.points for k in p.cell["scene"]), "device"]
        first = {bare(name): name for name in reversed(names)}
        return [n for n in dict.fromkeys(names) if first[bare(n)] == n and len(values(self.points, n)) > 1]

    def split(self, points: Sequence[Point], used: Iterable[str]) -> list[str]:
        """The axes, apart from `used`, that tell apart points of one label. Zipped axes need only one of them."""
        names, used = [], [bare(u) for u in used]
        for axis in self.axes:
            if bare(axis) not in used and _distinguishes(points, axis, [*used, *names]):
                names.append(axis)
        return names


def _of_scene(key: str, point: Point) -> str:
    """The name of a scene's key along which `Point.at` gives no parameter of a method."""
    return f"scene.{key}" if key in point.parameters else key


def without_record(count: int) -> str:
    """The words for so many planned cells that have no record."""
    return "1 planned cell has no record" if count == 1 else f"{count} planned cells have no record"


def series(result: Result, points: Sequence[Point], used: Iterable[str]) -> list[Point]:
    """The points with labels extended by what `used` leaves ambiguous: 'S-buffer, p_d 0.25'."""
    names = result.split(points, used)
    places = [(p.label, *(p.at(n) for n in names)) for p in points]
    following: dict[tuple, set[Any]] = {}  # by the beginning of a place
    for place in places:
        for at in range(1, len(place)):
            following.setdefault(place[:at], set()).add(place[at])
    return [replace(p, label=", ".join([p.label, *(heading(names[at - 1], place[at], " ")
                                                   for at in _telling(place, following))]))
            for p, place in zip(points, places, strict=True)]


def _telling(place: tuple, following: Mapping[tuple, set[Any]]) -> list[int]:
    """The parts of a place that a label has: all but words that every place of the same beginning shares."""
    return [at for at in range(1, len(place)) if place[at] is not None
            and (at == 1 or isinstance(place[at], (int, float)) or len(following[place[:at]]) > 1)]


def scene_words(points: Sequence[Point]) -> str:
    """The viewport and the scene of points that have much of it in common, in words; empty without points."""
    if not points:
        return ""
    parts = [f"{_range(values(points, 'size'))} pixels"]
    parts += [text.format(_range(found), _counted(points)) for name, text in SPELT_OUT.items()
              if (found := _values(points, name)) and not _unsaid(points, name, found)]
    parts += _found(points)
    parts += [f"{text}{_range(found, ', ')}" for name, text in SCENE_WORDS.items() if (found := values(points, name))]
    parts += [", ".join(dict.fromkeys(PurePath(file).name for file in values(points, "file")))]
    return "; ".join(part for part in parts if part)


def _unsaid(points: Iterable[Point], name: str, found: Sequence[Any]) -> bool:
    """Whether a key has no say in any of the scenes: each of them shades whatever it has."""
    return name == "fragment_probability" and found == [ALL_SHADED] and all(p.at("n") is None for p in points)


def _found(points: Iterable[Point]) -> list[str]:
    """The depth and the coverage that were counted in scenes that give neither, such as meshes."""
    rows = [p.row for p in points if p.at("n") is None]
    deepest = sorted({row["max_fragments"] for row in rows} - {None})
    covered = sorted({row["covered_pixels"] / (row["width"] * row["height"]) for row in rows
                      if row["covered_pixels"] is not None})
    ends = " … ".join(dict.fromkeys(percent(share) for share in covered[:1] + covered[-1:]))
    return ([f"up to {_range(deepest)} fragments per pixel"] if deepest else []) + (
        [f"{ends} of the pixels covered"] if covered else [])


def _counted(points: Iterable[Point]) -> str:
    """What n counts in the scenes of these points; see the kinds in docs/scenes.md."""
    scenes = [p.cell["scene"] for p in points if p.at("n") is not None]
    return " or ".join(dict.fromkeys(N_COUNTS.get(scene.get("layout"), EVERY) if scene.get("kind") == "quads"
                                     else MOST if scene.get("kind") in MOST_OF else EVERY for scene in scenes))


def _values(points: Sequence[Point], name: str) -> list[Any]:
    """The values along `name`; of k also those that were chosen for the frames of an animation."""
    found = values(points, name)
    frames = [frame.get("chosen_k") for p in points for frame in p.cell.get("frames") or [] if isinstance(frame, dict)]
    return sorted({*found, *(k for k in frames if k is not None)}) if name == "k" and found else found


def values(points: Iterable[Point], name: str) -> list[Any]:
    """Distinct coordinates along `name`, ascending where they are numbers, else in order of appearance."""
    found = list(dict.fromkeys(v for v in (p.at(name) for p in points) if v is not None))
    return sorted(found) if all(isinstance(v, (int, float)) for v in found) else found


def _range(found: Sequence[Any], between: str = " … ") -> str:
    """A value; of several the first and the last where they are numbers, else all."""
    if between != " … " or len(found) == 1:
        return between.join(map(plain, found))
    return between.join((plain(found[0]), plain(found[-1])))


def _distinguishes(points: Sequence[Point], axis: str, used: Sequence[str]) -> bool:
    seen: dict[tuple, Any] = {}
    for p in points:
        place = (p.label, *(p.at(u) for u in used))
        if seen.setdefault(place, p.at(axis)) != p.at(axis):
            return True
    return False

"""`kind: mesh`: triangles from a file of one's own, seen by an orthographic or a perspective camera."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from annotated_types import Interval

from ...effects import EFFECTS
from ..meshes.packages import FETCH, packaged
from ..spec.kind import CommonKeys, Described, EstimatedKind, Fault, FileKeys, late
from ..spec.values import STRICT, Allowed, Text

DIRECTIONS = ("-z", "+z", "-x", "+x", "-y", "+y")  # where the eye looks
UNUSED = ("pixel_density", "mean_depth", "colours")  # keys of every kind that a mesh has no use for

Vector = Annotated[tuple[float, float, float], Allowed("three numbers")]
Box = Annotated[tuple[float, float, float, float], Allowed("four numbers x0 y0 x1 y1")]
Degrees = Annotated[float, Interval(gt=0, lt=180), Allowed("degrees between 0 and 180")]


@dataclass(frozen=True, kw_only=True)
class Fit:
    """The rectangle of the plane across the direction that the viewport shows, in the mesh's units."""

    __pydantic_config__: ClassVar[dict] = STRICT

    box: Box


@dataclass(frozen=True, kw_only=True)
class View:
    """The direction that a mesh is seen from.

    direction: where the eye looks; up is +y (for -y and +y: -z). eye and target: two points instead; perspective only.
    fit: true shows all of the mesh with a margin; a box, orthographic only, shows exactly that. field: of view from
    bottom to top, in degrees, perspective only; without it the field is fitted to the mesh.
    """

    __pydantic_config__: ClassVar[dict] = STRICT

    projection: Literal["orthographic", "perspective"] = "orthographic"
    direction: Literal[DIRECTIONS] = "-z"
    eye: Vector | None = None
    target: Vector | None = None
    fit: Literal[True] | Fit = True
    field: Degrees | None = None


@dataclass(frozen=True, kw_only=True)
class Transform:
    """A mesh file, and where it stands: scaled, turned by degrees about x, then y, then z, and moved."""

    __pydantic_config__: ClassVar[dict] = STRICT

    file: Text
    scale: Annotated[float, Interval(gt=0), Allowed("a number above 0")] = 1.0
    rotate: Vector = (0.0, 0.0, 0.0)
    translate: Vector = (0.0, 0.0, 0.0)

    def __str__(self) -> str:
        return self.file


@dataclass(frozen=True, kw_only=True)
class MeshKeys(FileKeys):
    """The keys of meshes.

    file: OBJ, PLY, STL, GLB or glTF, relative to the config. files: several, each with a transform, instead. faces:
    the sides that are drawn. opaque: whether opaque triangles are drawn into a depth buffer first, where they hide
    what is behind them, or are stored like all others.
    depth_range: the window depths that the mesh lies in: from 1/2 on, where float32 steps evenly, all from 0 to 1, or
    all from 1 at the nearest to 0, where float32 steps finest far away.
    """

    files: Annotated[tuple[Transform, ...], Allowed("a list of mappings with file, scale, rotate, translate")] = ()
    view: View = View()
    faces: Literal["both", "front", "back"] = "both"
    opaque: Literal["depth", "store"] = "depth"
    depth_range: Literal["half", "whole", "reversed"] = late("half")


def _one_source(scene: CommonKeys) -> Fault | None:
    if bool(scene.file) != bool(scene.files):
        return None
    what = "both file and files" if scene.file else "no file"
    return ("scene.file", "scene.files", "scene.kind"), f"{what}; allowed: file, or files with a transform each"


def view_agrees(scene: CommonKeys) -> Fault | None:
    """Whether the keys of a view go together."""
    view, keys = scene.view, ("scene.view", "scene.kind")
    if (view.eye is None) != (view.target is None):
        return keys, "an eye without a target, or a target without an eye; allowed: both or neither"
    if view.projection == "orthographic" and (view.eye or view.field):
        return keys, "eye and field have no use in an orthographic view; allowed: with projection perspective"
    if view.projection == "perspective" and view.fit is not True:
        return keys, "a box has no use in a perspective view; allowed: with projection orthographic"
    if view.fit is not True and not (view.fit.box[0] < view.fit.box[2] and view.fit.box[1] < view.fit.box[3]):
        return keys, "an empty box; allowed: x0 below x1 and y0 below y1"
    return None


def _opaque_in_front(scene: CommonKeys) -> Fault | None:
    what = "opaque: depth with reversed depths; allowed: opaque: store"
    wrong = scene.depth_range == "reversed" and scene.opaque == "depth"
    return (("scene.depth_range", "scene.opaque"), what) if wrong else None


def _files_are_there(scene: CommonKeys) -> Fault | None:
    for path in paths(scene):
        if not (path.is_file() or packaged(path.name)):
            return ("scene.file", "scene.files"), f"{path}: no such file; allowed: an OBJ, PLY, STL, GLB or glTF file"
    return None


def _effect_sees_all(scene: CommonKeys) -> Fault | None:
    """An effect on objects takes every face of them."""
    if EFFECTS[scene.effect].needs == "nothing" or (scene.opaque == "store" and scene.faces == "both"):
        return None
    what = f"effect {scene.effect} needs both sides of all faces; allowed: with opaque store and faces both"
    return ("scene.effect", "scene.opaque", "scene.faces"), what


def _effect_measures(scene: CommonKeys) -> Fault | None:
    """Differences of depth are distances in an orthographic view alone."""
    even = scene.view.projection == "orthographic" and scene.depth_range != "reversed"
    if even or not EFFECTS[scene.effect].measures:
        return None
    what = (f"effect {scene.effect} takes differences of depth as lengths; allowed: with projection orthographic and "
            "depth_range half | whole")
    return ("scene.effect", "scene.view", "scene.depth_range"), what


def paths(scene: CommonKeys) -> list[Path]:
    """The files of a scene: next to its config, or those of this name that were fetched."""
    names = [scene.file] if scene.file else [part.file for part in scene.files]
    return [_place(Path(scene.folder or ".", name), name) for name in names]


def _missing(scene: CommonKeys) -> list[str]:
    """The names of files that have to be fetched first."""
    return [path.name for path in paths(scene) if not path.is_file()]


def _place(path: Path, name: str) -> Path:
    listed = packaged(name)
    return path if path.is_file() or not listed else listed[0].folder / name


class Mesh(EstimatedKind):
    """Triangles from files."""

    name = "mesh"
    noun = "triangles"
    geometry = "triangle"
    Keys = MeshKeys
    generator = "mesh.mesh"
    measured = True
    has_objects = True
    orders = ("random", "front_to_back", "back_to_front", "file", "object")
    alphas = ("material",)
    unused = UNUSED
    rules = (_one_source, view_agrees, _opaque_in_front, _files_are_there, _effect_sees_all, _effect_measures)
    rows = (Described("`mesh`", "triangles of one's own files", "measured", "measured", "what one renders"),)
    key_words = """\
- `file`: OBJ with MTL, PLY, STL, GLB or glTF, relative to the config, or the name of one that `mfr-bench meshes` lists
  and `mfr-bench meshes fetch` brings: until then its cells are `unsupported`, and say how to get it. Or `files`, a list
  of mappings with `file`, `scale`, `rotate` (degrees about x, y, z) and `translate`.
- `view: {projection: orthographic | perspective, direction: -z | +z | -x | +x | -y | +y}`: where the eye looks; up is
  +y, for ±y it is -z. A perspective view may have `eye` and `target` instead, and `field` in degrees. `fit: true` shows
  all of the mesh, `fit: {box: [x0, y0, x1, y1]}` exactly that rectangle of the plane across the direction. With
  `animate: true` the camera goes around the up axis in eight frames.
- `alpha`: `material` takes the opacities of the file; a number or a range replaces them.
- `order`: `file` as in the file, `object` by object and then as in the file, `random`, or by the depth of the middle.
- `faces: both | front | back`. A glTF material that is not double-sided shows its front only, whatever `faces` says.
- `opaque: depth` draws triangles with an alpha of 255 into a depth buffer first; fragments at or behind their depth are
  not generated, and their own colours are no part of the image. `opaque: store` stores them like all others.
- `depth_range: half` puts window depths into [1/2, 1), where float32 steps evenly by 2^-24; `whole` into [0, 1), as
  most renderers do; `reversed` goes from 1 at the nearest to 0, and shaders read it as depths that grow from the eye
  ([accuracy.md](accuracy.md#perspective-depths-near-1)). A method that tests against a depth buffer is `unsupported`
  there, and `opaque: depth` is refused.
"""

    def geometry_of(self, scene: CommonKeys) -> str:
        return "reversed" if scene.depth_range == "reversed" else "triangle"

    def rejects(self, scene: CommonKeys) -> bool:
        return scene.fragment_probability < 1 or scene.opaque == "depth"

    def lacks(self, scene: CommonKeys) -> str | None:
        if missing := _missing(scene):
            return f"{', '.join(missing)} on this machine; get it: {FETCH}"
        if scene.msaa > 1 and scene.opaque == "depth" and self.module.occludes(scene):
            return ("scene.opaque: store in several samples a pixel, since opaque triangles are drawn into a depth "
                    "buffer of one")
        return None

    def record(self, scene: CommonKeys) -> dict[str, Any]:
        digest = "not fetched" if _missing(scene) else self.module.digest(scene)
        return {"files": [path.name for path in paths(scene)], "digest": digest}

    def estimate(self, scene: CommonKeys):
        return self.module.guess(scene) if _missing(scene) else self.module.estimate(scene)


KIND = Mesh()

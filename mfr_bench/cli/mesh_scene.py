"""`--mesh FILE` and `--fragments FILE`: the settings that put a scene of one's own into a config."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path
from typing import Any

import click

from ..errors import UsageError, nearest
from .output import note

MESH, RECORDING = "an OBJ, PLY, STL, GLB or glTF file", "an .npz of recorded fragments (docs/recording.md)"
HOW = {  # to come by such a file
    MESH: "'mfr-bench meshes' lists some to fetch",
    RECORDING: "'mfr-bench scene CONFIG --fragments F.npz' writes one"}
MESH_CONFIG = "meshes"  # the config that --mesh and --fragments take where none is named
OPACITIES = [0.1, 0.6]  # of a mesh without a translucent triangle


class SceneFile(click.ParamType):
    """A file with a scene of one's own. `wanted`: what kind of file that is."""

    name = "file"

    def __init__(self, wanted: str):
        self._wanted = wanted

    def convert(self, value, param, context):
        if not value or Path(value).is_dir():
            self.fail(f"{value!r} is {'a folder' if value else 'no file'}; allowed: {self._wanted}")
        return value

    def shell_complete(self, context, param, incomplete):
        from click.shell_completion import CompletionItem

        return [CompletionItem(incomplete, type="file")]


def own_scene(remark: str = ""):
    """The two options of a command that takes a scene of one's own. `remark`: a sentence at the end of their help."""
    mesh = click.option("--mesh", metavar="FILE", type=SceneFile(MESH),
                        help=f"Take this mesh as the scene: OBJ, PLY, STL, GLB or glTF.{remark}")
    fragments = click.option("--fragments", metavar="FILE", type=SceneFile(RECORDING),
                             help="Take these recorded fragments as the scene: an .npz as mfr-bench scene --fragments "
                                  f"writes it.{remark}")
    return lambda command: mesh(fragments(command))


def overrides_of(mesh: str | None, fragments: str | None, settable: bool = True) -> list[str]:
    """Settings KEY=VALUE for the one of the files that is given, if any. Raises UsageError where both are.

    settable: whether the command takes --set, so that notes may name it.
    """
    if mesh is not None and fragments is not None:
        raise UsageError("--mesh with --fragments; allowed: one way to give the scene")
    if mesh is not None:
        _require("--mesh", mesh, MESH)
        return mesh_overrides(mesh, settable)
    if fragments is None:
        return []
    _require("--fragments", fragments, RECORDING)
    return fragment_overrides(fragments, settable)


def _require(option: str, file: str, wanted: str) -> None:
    """Raise UsageError where there is no file of that name."""
    path = Path(file)
    if not path.exists():
        beside = [each.name for each in path.parent.iterdir()] if path.parent.is_dir() else []
        raise UsageError(f"{option}: there is no file {file!r}; allowed: {wanted}{nearest(path.name, beside)}; "
                         f"{HOW[wanted]}")


def fragment_overrides(file: str, settable: bool = True) -> list[str]:
    """Settings KEY=VALUE for recorded fragments, as they were submitted. Raises UsageError for a bad file."""
    from ..scene.recording import samples_of, viewport_of

    path = Path(file).absolute()
    scene = {"kind": "fragments", "file": str(path), "size": viewport_of(path), "order": "file"}
    if (msaa := samples_of(path)) > 1:
        scene["msaa"] = msaa
        note(f"{path.name}: its coverage masks leave {msaa} samples a pixel"
             + "; --set scene.msaa=1 leaves them out" * settable)
    return [f"name=fragments-{_name_of(path, RECORDING)}", f"title={json.dumps(f'Methods on {path.name}')}",
            f"scene={json.dumps(scene)}"]


def mesh_overrides(file: str, settable: bool = True) -> list[str]:
    """Settings KEY=VALUE for the mesh, seen from the front. Raises UsageError for a file that does not do."""
    path = Path(file).absolute()
    return [f"name=mesh-{_name_of(path, MESH)}", f"title={json.dumps(f'Methods on {path.name}')}", "scene.kind=mesh",
            f"scene.file={json.dumps(str(path))}", "scene.view={}", f"scene.alpha={_alpha(path, settable)}"]


def _alpha(path: Path, settable: bool) -> str:
    """The file's own opacities where any triangle is translucent; else others, and a note that says so."""
    from ..scene.meshes.faces import OPAQUE
    from ..scene.meshes.read import read_mesh

    found = read_mesh(path)
    for line in found.notes:
        note(f"{path.name}: {line}")
    if (found.rgba[:, 3] < OPAQUE).any():
        return "material"
    note(f"{path.name}: every triangle is opaque; opacities from {OPACITIES[0]} to {OPACITIES[1]} stand for its own"
         + "; --set scene.alpha=0.5 sets another" * settable)
    return json.dumps(OPACITIES)


def _name_of(path: Path, wanted: str) -> str:
    """A name for results of the file: no two files of other contents, or of other endings, share a folder.

    Raises UsageError where there is no file; `wanted` says what kind of file is allowed.
    """
    from ..scene.files import digest

    return f"{_word(path.stem)}-{_word(path.suffix.lstrip('.').lower())}-{digest([path], wanted)[:6]}"


def _word(stem: str) -> str:
    """The text as a part of a folder's name."""
    return "".join(c if c.isascii() and (c.isalnum() or c in "-_") else "-" for c in stem)[:60] or "file"


def as_written(scene) -> dict[str, Any]:
    """The scene as a config elsewhere could have it: the keys that are not at their defaults, files by whole paths."""
    from ..scene.spec.kind import LOCAL
    from ..scene.spec.values import plain

    found = {key.name: plain(getattr(scene, key.name)) for key in fields(scene)
             if not key.metadata.get(LOCAL) and getattr(scene, key.name) != key.default}
    whole = Path(scene.folder or ".").absolute()
    if scene.file:
        found["file"] = str(whole / scene.file)
    for part in found.get("files", ()):
        part["file"] = str(whole / part["file"])
    view = {key: value for key, value in found.get("view", {}).items() if value is not None}
    return {**found, **({"view": view} if view else {})}

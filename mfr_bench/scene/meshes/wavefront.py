"""OBJ with MTL, and STL (Open Asset Import Library): every face in file order, none merged and none left out."""

from __future__ import annotations

import re
import tempfile
from codecs import BOM_UTF8
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from .companions import LIBRARY
from .faces import NONE, Faces, bytes_of, joined
from .library import library
from .textures import NOTE, mean_colour

GREY = 0.7  # of what has no material
HALO = re.compile(rb"^([ \t]*d[ \t]+)-halo[ \t]+", re.MULTILINE)  # the opacity where a surface is seen face on
NO_FACE = re.compile(rb"^(?:[lp][ \t].*|f[ \t]+\S+(?:[ \t]+\S+)?[ \t]*\r?)$", re.MULTILINE)  # fewer than three corners


def read(path: Path) -> Faces:
    """The triangles of the file. Raises ValueError for a file that does not hold, with the library's reason."""
    assimp = library("assimp_py", path)
    with _mended(path) as file:
        try:
            scene = assimp.import_file(str(file), assimp.Process_Triangulate)
        except RuntimeError as error:
            reason = str(error).replace(str(file), path.name).replace(f"Assimp error loading '{path.name}': ", "")
            raise ValueError(reason.strip() or "the file cannot be parsed") from None
    nodes = (node for node in (scene.root_node, *scene.root_node.children) if node.mesh_indices)
    parts = [_part(scene.meshes[index], scene.materials, number, path)
             for number, node in enumerate(nodes) for index in node.mesh_indices]
    faces = joined(parts, renumber=False) if parts else NONE
    return replace(faces, notes=(*faces.notes, *_lacking(path)))


def _lacking(path: Path) -> Iterator[str]:
    """A sentence for each material file that an OBJ names and that is not there, nor one of the OBJ's own name."""
    if path.suffix.lower() == ".obj" and not path.with_suffix(".mtl").is_file():
        for name in dict.fromkeys(LIBRARY.findall(path.read_bytes())):
            named = name.decode(errors="replace").replace("\\", "/")
            if not (path.parent / named).is_file():
                yield f"the material file {named} is not there; what it would colour is grey and opaque"


@contextmanager
def _mended(path: Path) -> Iterator[Path]:
    """The file, or a copy of an OBJ without what the library refuses or takes amiss.

    It refuses lines, points, faces of two corners, and opacities with `-halo`; it skips a first line that a byte order
    mark stands before.
    """
    text = path.read_bytes() if path.suffix.lower() == ".obj" else b""
    libraries = {file: file.read_bytes() for file in _libraries(path, text)}
    if not (NO_FACE.search(text) or text.startswith(BOM_UTF8) or any(map(HALO.search, libraries.values()))):
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        for file, materials in libraries.items():
            Path(folder, file.name).write_bytes(HALO.sub(rb"\1", materials))
        copy = Path(folder, path.name)
        copy.write_bytes(NO_FACE.sub(b"", text.removeprefix(BOM_UTF8)))
        yield copy


def _libraries(path: Path, text: bytes) -> list[Path]:
    """The material files that an OBJ names, and that are there."""
    found = [path.parent / name.decode(errors="replace") for name in LIBRARY.findall(text)]
    return [file for file in found if file.is_file()]


def _part(mesh, materials: list[dict], number: int, path: Path) -> Faces:
    """A run of faces with one material, of the object with this number."""
    index = np.asarray(mesh.indices if mesh.num_indices else (), dtype=np.int64).reshape(-1, 3)
    place = np.asarray(mesh.vertices, dtype=np.float64).reshape(-1, 3)
    colour, notes = _material_colour(materials[mesh.material_index], path)
    rgba = np.tile(colour, (len(index), 1))
    if mesh.colors:
        rgba = _of_corners(np.asarray(mesh.colors[0], dtype=np.float64).reshape(len(place), -1), index, colour[3])
    return Faces(place[index], bytes_of(rgba), np.full(len(index), number, np.int32), np.zeros(len(index), bool),
                     notes)


def _of_corners(colours: np.ndarray, index: np.ndarray, alpha: float) -> np.ndarray:
    """float64 (t, 4): the mean of each triangle's corner colours, times the material's alpha."""
    full = np.ones((len(colours), 4))
    full[:, :colours.shape[1]] = colours
    mean = full[index].mean(axis=1)
    return mean * [1.0, 1.0, 1.0, alpha]


def _material_colour(material: dict, path: Path) -> tuple[np.ndarray, tuple[str, ...]]:
    """float64 (4,): diffuse colour, times the mean of its texture, with the opacity that `d` or `Tr` gives."""
    diffuse = np.asarray(material.get("COLOR_DIFFUSE", [GREY] * 3), dtype=np.float64)[:3]
    colour = np.array([*diffuse, float(material.get("OPACITY", 1.0))])
    textures = [name for names in (material.get("TEXTURES") or {}).values() for name in np.atleast_1d(names)]
    if not textures:
        return colour, ()
    file = path.parent / str(textures[0]).replace("\\", "/")
    if not file.is_file():
        return colour, (f"the texture {textures[0]} is not there; its material's own colour stands for it",)
    return colour * [*mean_colour(file, f"{path}: {textures[0]}")[:3], 1.0], (NOTE,)

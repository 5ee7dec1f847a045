"""The files that a mesh file names, and is nothing without: materials, textures, buffers."""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from urllib.parse import unquote

LIBRARY = re.compile(rb"^[ \t]*mtllib[ \t]+(.+?)\s*$", re.MULTILINE)
TEXTURE = re.compile(rb"^[ \t]*(?:map_\w+|bump|norm|disp|decal|refl)[ \t]+(?:.*[ \t])?(\S+)\s*$", re.MULTILINE)
GLB_MAGIC, GLB_START = b"glTF", 12  # bytes before the first chunk, which is the JSON


@lru_cache(maxsize=64)
def companions(path: Path, stamped: tuple[int, int]) -> tuple[Path, ...]:
    """The files that this one names, those that they name after them, each once; only what is there.

    `stamped` tells a changed file from the former (`scene.files.stamp`).
    """
    named = NAMED.get(path.suffix.lower())
    found = [path.parent / name for name in named(path)] if named else []
    return tuple(dict.fromkeys(file for file in found if file.is_file()))


def _of_obj(path: Path) -> Iterator[str]:
    for library in LIBRARY.findall(path.read_bytes()):
        name = _text(library)
        file = path.parent / name
        if not file.is_file():  # the reader then takes the library of the file's own name
            name, file = f"{path.stem}.mtl", path.with_suffix(".mtl")
        yield name
        if file.is_file():
            yield from (_text(texture) for texture in TEXTURE.findall(file.read_bytes()))


def _of_gltf(path: Path) -> Iterator[str]:
    try:
        document = json.loads(_json_of(path.read_bytes()))
        parts = [part for kind in ("buffers", "images") for part in document.get(kind) or ()]
        yield from (unquote(part["uri"]) for part in parts if not part.get("uri", "data:").startswith("data:"))
    except (ValueError, TypeError, AttributeError, KeyError, struct.error):
        return  # whoever reads the mesh says what is wrong with it


def _json_of(data: bytes) -> bytes:
    if not data.startswith(GLB_MAGIC):
        return data
    length, = struct.unpack_from("<I", data, GLB_START)
    return data[GLB_START + 8:GLB_START + 8 + length]


def _text(name: bytes) -> str:
    return name.decode(errors="replace").replace("\\", "/").replace("\0", "")


NAMED = {".obj": _of_obj, ".gltf": _of_gltf, ".glb": _of_gltf}

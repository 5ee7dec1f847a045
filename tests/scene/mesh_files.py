"""Writes small mesh files for tests: every trap that readers of these formats are known to fall into."""

import json
import struct
from collections.abc import Mapping
from pathlib import Path

import numpy as np

TRIANGLE = ((0, 0, 0), (1, 0, 0), (0, 1, 0))


def write_glb(path: Path, primitives: list[dict], materials: list[dict], nodes: list[dict], roots: list[int],
              instead: Mapping[str, object] | None = None) -> Path:
    """A GLB; a primitive has `position`, optional `colour` (n, 4), `index`, `mode`, `material`, and is a mesh.

    `instead` replaces members of the document.
    """
    blob, views, accessors, meshes = b"", [], [], []

    def accessor(values: np.ndarray, kind: str, component: int) -> int:
        nonlocal blob
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": values.nbytes})
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(values), "type": kind})
        blob += values.tobytes() + bytes(-values.nbytes % 4)
        return len(accessors) - 1

    for given in primitives:
        made = {"attributes": {"POSITION": accessor(np.float32(given["position"]), "VEC3", 5126)}}
        if "colour" in given:
            made["attributes"]["COLOR_0"] = accessor(np.float32(given["colour"]), "VEC4", 5126)
        if "index" in given:
            made["indices"] = accessor(np.uint16(given["index"]), "SCALAR", 5123)
        meshes.append({"primitives": [made | {k: given[k] for k in ("mode", "material", "extensions") if k in given}]})
    document = {"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(blob)}], "bufferViews": views,
                "accessors": accessors, "meshes": meshes, "materials": materials, "nodes": nodes,
                "scenes": [{"nodes": roots}], "scene": 0}
    text = json.dumps(document | (instead or {})).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(blob), 0x004E4942) + blob
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    return path


def surface(alpha: float, **more) -> dict:
    """A red material of this base alpha."""
    return {"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, alpha]}, **more}


def stl(*triangles) -> bytes:
    """A binary STL."""
    body = b"".join(struct.pack("<12fH", 0, 0, 1, *np.ravel(t), 0) for t in triangles)
    return b"made for a test".ljust(80) + struct.pack("<I", len(triangles)) + body


def ply(vertices: list[str], faces: list[str], vertex_properties=("float x", "float y", "float z"),
        face_properties=()) -> str:
    """An ASCII PLY."""
    head = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}",
            *(f"property {p}" for p in vertex_properties), f"element face {len(faces)}",
            "property list uchar int vertex_indices", *(f"property {p}" for p in face_properties), "end_header"]
    return "\n".join([*head, *vertices, *faces]) + "\n"

"""glTF 2.0 and GLB: the nodes of a scene in the file's order, with their transforms; pygltflib reads the container."""

from __future__ import annotations

import base64
import binascii
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

import numpy as np

from .faces import NONE, Faces, bytes_of, joined
from .library import library
from .textures import NOTE, mean_colour

COMPONENTS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
UNDERSTOOD = {"KHR_materials_clearcoat", "KHR_materials_emissive_strength", "KHR_materials_ior", "KHR_materials_sheen",
              "KHR_materials_specular", "KHR_materials_unlit", "KHR_mesh_quantization", "KHR_texture_transform"}
LIST, STRIP, FAN = 4, 5, 6  # modes of a primitive that have faces


def read(path: Path) -> Faces:
    """The triangles of the file's scene. Raises ValueError or IndexError for a file that does not hold."""
    pygltflib = library("pygltflib", path)
    gltf = pygltflib.GLTF2().load(str(path))
    if gltf is None or not (gltf.asset and str(gltf.asset.version).startswith("2")):
        raise ValueError("it is not glTF 2.0")
    unknown = sorted(set(gltf.extensionsRequired or ()) - UNDERSTOOD)
    if unknown:
        raise ValueError(f"it needs the extension {unknown[0]}, which is not read here; save it without compression")
    document = Document(gltf, path)
    parts = list(document.parts())
    return joined(parts, renumber=False) if parts else NONE


class Document:
    """A loaded glTF file with its buffers."""

    def __init__(self, gltf, path: Path):
        self.gltf, self.path = gltf, path
        self._buffers: dict[int, bytes] = {}
        self._colours: dict[int | None, tuple] = {}

    def parts(self) -> Iterator[Faces]:
        """Each primitive with faces, depth first through the nodes of the default scene."""
        if not self.gltf.scenes:
            raise ValueError("it has no scene")
        for number, (node, matrix) in enumerate(self._nodes(self.gltf.scenes[self.gltf.scene or 0].nodes or ())):
            if node.mesh is not None:
                for primitive in self.gltf.meshes[node.mesh].primitives:
                    yield self._primitive(primitive, number).moved(matrix)

    def _nodes(self, roots) -> Iterator[tuple]:
        """Nodes with the matrices that take them to the scene. Raises ValueError where a node is below itself."""
        todo = [(index, np.eye(4), frozenset()) for index in reversed(list(roots))]
        while todo:
            index, above, path = todo.pop()
            if index in path:
                raise ValueError(f"node {index} is a child of itself")
            node = self.gltf.nodes[index]
            matrix = above @ local_matrix(node)
            yield node, matrix
            todo += [(child, matrix, path | {index}) for child in reversed(node.children or [])]

    def _primitive(self, primitive, number: int) -> Faces:
        mode = LIST if primitive.mode is None else primitive.mode
        if mode not in (LIST, STRIP, FAN):
            return NONE
        if "KHR_draco_mesh_compression" in (primitive.extensions or {}):
            raise ValueError("it is compressed with Draco, which is not read here; save it without compression")
        place = self._accessor(primitive.attributes.POSITION).astype(np.float64)
        corner = np.arange(len(place)) if primitive.indices is None else self._accessor(primitive.indices)[:, 0]
        corner = corner.astype(np.int64)
        if corner.size and corner.max() >= len(place):
            raise IndexError(f"a face names vertex {corner.max()} of {len(place)}, counted from 0")
        index = faces(corner, mode)
        colour, one_sided, cutoff, blends, notes = self._material(primitive.material)
        rgba = np.tile(colour, (len(index), 1))
        if getattr(primitive.attributes, "COLOR_0", None) is not None:
            rgba *= self._vertex_colours(primitive.attributes.COLOR_0)[index].mean(axis=1)
        kept = rgba[:, 3] >= cutoff
        if not blends:
            rgba[:, 3] = 1.0
        count = len(index)
        return Faces(place[index], bytes_of(rgba), np.full(count, number, np.int32), np.full(count, one_sided),
                         notes).chosen(kept)

    def _vertex_colours(self, accessor: int) -> np.ndarray:
        values = self._accessor(accessor)
        colours = np.ones((len(values), 4))
        colours[:, :values.shape[1]] = values
        return colours

    def _material(self, index: int | None) -> tuple[np.ndarray, bool, float, bool, tuple[str, ...]]:
        """Colour (4,), whether it is seen from the front only, the alpha cut-off, whether alpha blends, and notes.

        By glTF 2.0 §3.9.4 the alpha of an OPAQUE material, which is the default, is ignored, and a MASK one is either
        opaque or not there.
        """
        if index not in self._colours:
            self._colours[index] = self._read_material(index)
        return self._colours[index]

    def _read_material(self, index: int | None) -> tuple[np.ndarray, bool, float, bool, tuple[str, ...]]:
        if index is None:
            return np.ones(4), True, 0.0, False, ()
        material = self.gltf.materials[index]
        surface, notes = material.pbrMetallicRoughness, ()
        colour = np.array((surface and surface.baseColorFactor) or [1.0] * 4, dtype=np.float64)
        if surface and surface.baseColorTexture is not None:
            mean = self._texture(surface.baseColorTexture.index)
            colour, notes = (colour, ()) if mean is None else (colour * mean, (NOTE,))
        cutoff = 0.5 if material.alphaCutoff is None else float(material.alphaCutoff)
        mode = material.alphaMode or "OPAQUE"
        return colour, not material.doubleSided, cutoff if mode == "MASK" else 0.0, mode == "BLEND", notes

    def _texture(self, index: int) -> np.ndarray | None:
        source = self.gltf.textures[index].source
        if source is None:
            return None
        image = self.gltf.images[source]
        where = f"{self.path}: image {source}"
        if image.bufferView is not None:
            view = self.gltf.bufferViews[image.bufferView]
            start = view.byteOffset or 0
            return mean_colour(self._buffer(view.buffer)[start:start + view.byteLength], where)
        return mean_colour(self._resource(image.uri), where)

    def _accessor(self, index: int) -> np.ndarray:
        """The values of an accessor, (count, components), in its own type. Raises ValueError where they do not fit."""
        accessor = self.gltf.accessors[index]
        if accessor.sparse is not None:
            raise ValueError(f"accessor {index} is sparse, which is not read here; save it without")
        if accessor.componentType not in COMPONENTS or accessor.type not in WIDTHS:
            raise ValueError(f"accessor {index} has the type {accessor.type} of {accessor.componentType}")
        dtype, width = np.dtype(COMPONENTS[accessor.componentType]).newbyteorder("<"), WIDTHS[accessor.type]
        if accessor.bufferView is None:
            return np.zeros((accessor.count, width), dtype)
        view = self.gltf.bufferViews[accessor.bufferView]
        data, step = self._buffer(view.buffer), view.byteStride or dtype.itemsize * width
        start = (view.byteOffset or 0) + (accessor.byteOffset or 0)
        end = start + (accessor.count - 1) * step + dtype.itemsize * width
        if accessor.count < 0 or start < 0 or (accessor.count and end > len(data)):
            raise ValueError(f"accessor {index} ends at byte {end} of a buffer of {len(data)} bytes")
        found = np.ndarray((accessor.count, width), dtype, data, start, (step, dtype.itemsize))
        return _scaled(found) if accessor.normalized and dtype.kind in "iu" else found

    def _buffer(self, index: int) -> bytes:
        if index not in self._buffers:
            buffer = self.gltf.buffers[index]
            held = self.gltf.binary_blob() if buffer.uri is None else self._resource(buffer.uri)
            data = held.read_bytes() if isinstance(held, Path) else held
            if data is None or len(data) < buffer.byteLength:
                raise ValueError(f"buffer {index} has {len(data or b'')} of {buffer.byteLength} bytes")
            self._buffers[index] = data
        return self._buffers[index]

    def _resource(self, uri: str) -> bytes | Path:
        """The bytes of a data URI, or of the file next to this one that it names. Raises ValueError for any other."""
        if uri.startswith("data:"):
            try:
                return base64.b64decode(uri.partition(",")[2], validate=True)
            except binascii.Error as error:
                raise ValueError(f"a data URI does not decode: {error}") from None
        file = self.path.parent / unquote(uri)
        if "://" in uri or not file.is_file():
            raise ValueError(f"the file {uri} is not there")
        return file


def _scaled(values: np.ndarray) -> np.ndarray:
    """Normalized integers as numbers in [-1, 1], unsigned ones in [0, 1] (glTF 2.0 §3.6.2.2)."""
    return np.maximum(values / np.iinfo(values.dtype).max, -1.0)


def faces(corner: np.ndarray, mode: int) -> np.ndarray:
    """int64 (t, 3): the triangles of a list, a strip or a fan of corners, all with the same side in front."""
    if mode == LIST:
        return corner[:len(corner) // 3 * 3].reshape(-1, 3)
    count = max(0, len(corner) - 2)
    at = np.arange(count)
    if mode == FAN:
        return np.stack([corner[np.zeros(count, np.int64)], corner[at + 1], corner[at + 2]], axis=-1)
    odd = at % 2
    return np.stack([corner[at], corner[at + 1 + odd], corner[at + 2 - odd]], axis=-1)


def local_matrix(node) -> np.ndarray:
    """float64 (4, 4): a node's transform, given as a matrix by columns or as translation, rotation and scale."""
    if node.matrix:
        return np.array(node.matrix, dtype=np.float64).reshape(4, 4).T
    x, y, z, w = node.rotation or (0.0, 0.0, 0.0, 1.0)
    matrix = np.eye(4)
    matrix[:3, :3] = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]) * np.array(node.scale or (1.0, 1.0, 1.0))
    matrix[:3, 3] = node.translation or (0.0, 0.0, 0.0)
    return matrix

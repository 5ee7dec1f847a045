"""Makes the scenes of `kind: strands`: places polylines before a camera and widens them into strips."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from ..hashing import WORD, hash3
from . import files
from .coverage import Estimate, estimate_of
from .mesh import camera_of
from .objects import direction
from .parameters import Scene
from .polylines import WANTED, Polylines, read_polylines
from .streams import CURL, GROWTH, LENGTH, ROOT, TURN
from .strips import Strips, strips

SCALP_FROM = -0.25  # height, in radii of the head, above which hair grows
FALL = 0.22  # share of a piece's direction that gravity takes
CURLS = 3  # turns of a curl along a strand, at most
CURL_WIDTH = 0.35  # of a piece, across its direction


def hair(config: Scene, frame: int = 0) -> Strips:
    """The strands of a config, as an animation's frame shows them. Raises UsageError for a file that does not do."""
    found = polylines(config)
    clip = camera_of(config, found.points, frame).clip(found.points)
    first, strand = found.pieces
    width = max(config.width, 1.0) if config.thin == "alpha" else config.width
    left, right = _sides(clip, found, width, config.size)
    corners = np.stack([left[first], right[first], left[first + 1], right[first + 1]], axis=1)
    before = (corners[..., 3] > 0).all(axis=1)
    return strips(_thinned(config), corners[before], config.seed, part_of=strand[before].astype(np.uint64))


def _thinned(config: Scene) -> Scene:
    """The config with the alpha of strands that are drawn wider than they are."""
    if config.thin == "sliver" or config.width >= 1:
        return config
    return replace(config, alpha=tuple(alpha * config.width for alpha in config.alpha))


def _sides(clip: np.ndarray, found: Polylines, width: float, size: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Both edges of the strands at their points, in clip space (n, 4): half a width away, across them on the screen."""
    w = np.where(clip[:, 3:] > 0, clip[:, 3:], 1.0)
    pixel = np.array(size) / 2.0
    along = found.tangents(clip[:, :2] / w * pixel)
    length = np.sqrt(along[:, :1] ** 2 + along[:, 1:] ** 2)
    along = np.where(length > 0, along / np.where(length > 0, length, 1.0), [1.0, 0.0])
    across = np.stack([-along[:, 1], along[:, 0]], axis=-1) * (width / 2) / pixel * w
    offset = np.concatenate([across, np.zeros_like(across)], axis=-1)
    return clip + offset, clip - offset


def polylines(config: Scene) -> Polylines:
    """The strands in the world: those of the file, or hair on a head of radius 1."""
    if config.file:
        return _read(str(config.file_path), files.stamp(config.file_path, WANTED))
    return _grown(config)


@lru_cache(maxsize=2)
def _read(path: str, _stamped: tuple[int, int]) -> Polylines:
    return read_polylines(path)


def digest(config: Scene) -> str:
    """Hash of the contents of the file."""
    return files.digest([config.file_path], WANTED)


@lru_cache(maxsize=64)
def estimate(config: Scene) -> Estimate:
    """About how the strands cover the viewport."""
    return estimate_of(hair(config))


def _grown(config: Scene) -> Polylines:
    """Strands that leave a head across its surface, curl, fall, and lie on it where they would enter it.

    Only operations that every machine rounds alike: the same seed gives the same points.
    """
    strand = np.arange(config.strands, dtype=np.uint64)

    def noise(stream: int) -> np.ndarray:
        return hash3(strand, stream, config.seed) / WORD

    y = SCALP_FROM + (1.0 - SCALP_FROM) * noise(ROOT)
    cosine, sine = direction(noise(TURN))
    around = np.sqrt(1.0 - y * y)
    point = np.stack([around * cosine, y, around * sine], axis=-1)
    ahead, made = point.copy(), [point]
    step = (1.0 + 0.8 * noise(LENGTH)) / config.segments
    curl, phase = CURLS * (noise(CURL) - 0.5), noise(GROWTH)
    for piece in range(config.segments):
        swing = np.stack(direction(phase + curl * piece / config.segments), axis=-1) * CURL_WIDTH
        ahead = _unit(ahead * (1.0 - FALL) + np.array([0.0, -FALL, 0.0]))
        sideways = np.stack([swing[:, 0], np.zeros(len(swing)), swing[:, 1]], axis=-1)
        point = _outside(point + _unit(ahead + sideways) * step[:, None])
        made.append(point)
    return Polylines(np.stack(made, axis=1).reshape(-1, 3), np.full(config.strands, config.segments + 1))


def _unit(vectors: np.ndarray) -> np.ndarray:
    x, y, z = vectors.T
    return vectors / np.sqrt(x * x + y * y + z * z)[:, None]


def _outside(points: np.ndarray) -> np.ndarray:
    """The points, those within the head moved to its surface."""
    x, y, z = points.T
    distance = np.sqrt(x * x + y * y + z * z)[:, None]
    return np.where(distance < 1.0, points / np.where(distance > 0, distance, 1.0), points)

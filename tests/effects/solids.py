"""Closed objects as OBJ files, faces counter-clockwise from outside, for tests of effects."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

Solid = tuple[list[tuple[float, ...]], list[tuple[int, ...]]]  # corners, and faces as indices of them from 0


def box(low: Sequence[float], high: Sequence[float]) -> Solid:
    """An axis-aligned box."""
    corners = [tuple((low, high)[i >> axis & 1][axis] for axis in range(3)) for i in range(8)]
    return corners, [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def ball(centre: Sequence[float], radius: float, around: int, rings: int) -> Solid:
    """A sphere with corners on it, poles at its greatest and least y."""
    x, y, z = centre
    corners: list[tuple[float, ...]] = [(x, y + radius, z)]
    for ring in range(1, rings):
        up, out = radius * math.cos(math.pi * ring / rings), radius * math.sin(math.pi * ring / rings)
        turns = (2 * math.pi * i / around for i in range(around))
        corners += [(x + out * math.sin(turn), y + up, z + out * math.cos(turn)) for turn in turns]
    corners.append((x, y - radius, z))
    faces: list[tuple[int, ...]] = []
    for i in range(around):
        rows = [(1 + r * around + i, 1 + r * around + (i + 1) % around) for r in range(rings - 1)]  # left and right
        faces.append((0, *rows[0]))
        faces += [(upper[0], lower[0], lower[1], upper[1]) for upper, lower in pairwise(rows)]
        faces.append((rows[-1][0], len(corners) - 1, rows[-1][1]))
    return corners, faces


def write(path: Path, *solids: Solid, colours: Sequence[Sequence[float]] = ((1, 0, 0), (0, 0, 1))) -> Path:
    """The solids as objects of one OBJ, each with a material of its own of opacity 1/2."""
    lines, first = [f"mtllib {path.stem}.mtl"], 1
    for number, (corners, faces) in enumerate(solids):
        lines += [f"o solid{number}", *(f"v {x!r} {y!r} {z!r}" for x, y, z in corners), f"usemtl m{number}"]
        lines += ["f " + " ".join(str(first + i) for i in face) for face in faces]
        first += len(corners)
    path.write_text("\n".join(lines) + "\n")
    materials = [f"newmtl m{n}\nKd {r} {g} {b}\nd 0.5\n" for n, (r, g, b) in enumerate(colours)]
    path.with_suffix(".mtl").write_text("".join(materials))
    return path

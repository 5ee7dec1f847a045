"""Real meshes that packages on PyPI carry: which they are, and where their files are kept on this machine.

Knows no numpy, since configs ask it. `fetch` brings the files.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

FETCH = "mfr-bench meshes fetch"
PLACE = "MFR_BENCH_MESHES"  # environment variable: the folder of all files


@dataclass(frozen=True)
class Mesh:
    """A mesh file, as `name` here.

    members: its path in the package, and those of files that it refers to; a pattern stands for several binary STL
    files, which become one in the order of their names. faces: triangles of it.
    """

    name: str
    members: tuple[str, ...]
    faces: int
    what: str


@dataclass(frozen=True)
class Package:
    """A release on PyPI, of which one file, with this hash, is taken on every machine; nothing of it is run.

    options: what pip is told, to choose that file.
    """

    name: str
    version: str
    sha256: str
    size_mb: int
    licence: str
    meshes: tuple[Mesh, ...]
    options: tuple[str, ...] = ()

    @property
    def folder(self) -> Path:
        """The folder in which its meshes are kept."""
        return meshes_dir() / f"{self.name}-{self.version}"

    @property
    def missing(self) -> list[Mesh]:
        """Its meshes that are not there yet."""
        return [mesh for mesh in self.meshes if not (self.folder / mesh.name).is_file()]


_DATA = "pybullet_data/"
PACKAGES = (
    Package(
        "pybullet", "3.2.7", "5d858abf7c12a21ef3ed351cf81dac1b5e486ec25c9ab59bfc84beb89034edff", 103, "zlib",
        (Mesh("samurai_monastry.obj", (f"{_DATA}samurai_monastry.obj", f"{_DATA}samurai_monastry.mtl"), 124_789,
              "a monastery of many walls and roofs"),
         Mesh("channel.stl", (f"{_DATA}quadruped/microtaur/channel.stl",), 30_716, "a channel of sheet metal"),
         Mesh("xavier.stl", (f"{_DATA}quadruped/microtaur/xavier.stl",), 23_002, "a computer board"),
         Mesh("pod_lowres.stl", (f"{_DATA}kiva_shelf/meshes/pod_lowres.stl",), 10_184, "a shelf of a warehouse"),
         Mesh("bunny.obj", (f"{_DATA}bunny.obj",), 902, "a bunny of few triangles")),
        ("--platform", "manylinux2014_x86_64", "--python-version", "3.11", "--implementation", "cp", "--abi", "cp311")),
    Package(
        "dm-control", "1.0.50", "5434e1e51ff69016867426da7df6064b18d140e4d0a628f879bbcf0e7d0a586d", 57, "Apache-2.0",
        (Mesh("dog_bones.stl", ("dm_control/suite/dog_assets/BONE*.stl",), 312_904, "172 bones of a dog"),)),
)


def meshes_dir() -> Path:
    """The folder of all fetched meshes: that of the environment variable, or one in the user's cache."""
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return Path(os.environ.get(PLACE) or cache / "mfr-bench" / "meshes")


def packaged(name: str) -> tuple[Package, Mesh] | None:
    """The package and the mesh of this name; None where none is listed."""
    return next(((package, mesh) for package in PACKAGES for mesh in package.meshes if mesh.name == name), None)

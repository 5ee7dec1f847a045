"""What a figure is drawn from, as a digest that its files bear: where it is the same, a whole file is left as it is."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Sequence
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from ...store import ResultFolder
from .. import printed, style
from ..data import Result
from . import seal
from .kinds import KINDS
from .series import tie_losers

MARK, LENGTH = "drawn from sha256:", 64
HEAD_BYTES = 2048  # of a file, where its mark stands
LIBRARIES = ("matplotlib", "numpy", "pillow")
UNSEEN = ("split_s", "beside_s", "environment", "calibration_end", "calibration_drift", "left_out",
          "refused")  # of a manifest
CODE = (  # all that drawing loads, but for the declarations of methods, of which `_of_the_catalog` has what is drawn
    "__init__.py", "effects", "environment.py", "errors.py", "lazy.py", "markdown.py", "methods/__init__.py",
    "methods/checking.py", "methods/loading.py", "methods/outside.py", "methods/shared", "methods/spec", "parallel.py",
    "report/__init__.py", "report/breaking.py", "report/checkerboard.py", "report/data", "report/figures",
    "report/frontier.py", "report/printed.py", "report/reference.py", "report/style.py", "resources.py", "stats.py",
    "store")
PACKAGE = Path(__file__).resolve().parents[2]


def marks(folder: ResultFolder, stems: Sequence[Path]) -> list[str]:
    """The mark of each figure of a folder. Empty where a file could not be used: that is told anew each time."""
    manifest = folder.manifest()
    result = Result(folder, manifest, ())
    shared = hashlib.sha256(_text([_code(), _libraries(), _of_the_catalog(), list(map(repr, printed.rows(result)))]))
    shared.update(_text({name: value for name, value in manifest.items() if name not in (*UNSEEN, "figures")}))
    arrays = any(_has_arrays(options) for options in result.figures)
    try:
        for name, content in _files(folder, arrays):
            shared.update(f"{name} {len(content)}\n".encode() + content)
    except (OSError, ValueError):
        return [""] * len(stems)
    if folder.damaged:
        return [""] * len(stems)
    return [_mark(shared, stem.name, options) for stem, options in zip(stems, result.figures, strict=True)]


def current(path: Path, mark: str) -> bool:
    """Whether a file bears this mark and is whole."""
    return bool(mark) and mark_of(path) == mark


def mark_of(path: Path) -> str:
    """The mark that a whole file of a figure bears; empty without."""
    try:
        content = path.read_bytes()
    except OSError:
        return ""
    found = re.search(rb"%b[0-9a-f]{%d}" % (MARK.encode(), LENGTH), content[:HEAD_BYTES])
    return found[0].decode() if found and seal.WHOLE[path.suffix](content) else ""


def _mark(shared: Any, name: str, options: Any) -> str:
    found = shared.copy()
    found.update(_text([name, options]))
    return f"{MARK}{found.hexdigest()}"


def _has_arrays(options: Any) -> bool:
    return options.get("kind") in KINDS and KINDS[options["kind"]].arrays


def _files(folder: ResultFolder, arrays: bool) -> Iterator[tuple[str, bytes]]:
    """Names and contents of the records, and of the arrays where they are drawn, loose or packed."""
    content = folder.reader()
    for name in folder.names():
        if arrays or name.endswith(".json"):
            yield name, content(name)


@cache
def _code() -> str:
    """The digest of the code that draws."""
    found = hashlib.sha256()
    for place in CODE:
        at = PACKAGE / place
        for path in sorted(at.rglob("*.py")) if at.is_dir() else [at]:
            found.update(str(path.relative_to(PACKAGE)).encode() + path.read_bytes())
    return found.hexdigest()


@cache
def _libraries() -> list[str]:
    return [f"{name} {metadata.version(name)}" for name in LIBRARIES]


def _of_the_catalog() -> list[Any]:
    """The catalog's part in a figure: colours of methods, and which of them lose fragments of equal depth."""
    return [style.method_colours(), sorted(tie_losers())]


def _text(value: Any) -> bytes:
    return json.dumps(value, sort_keys=True, ensure_ascii=False, default=str).encode()

"""The package that `mfr-bench new-method NAME` writes: the example of this project, under another name."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from ..errors import StoreError, UsageError
from ..resources import template_dir

EXAMPLE = "my-array"  # the name of the example, in its files and in theirs
NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


def files(name: str) -> Iterator[tuple[Path, str]]:
    """The files of a package of this name: each path inside its folder, and its text. Raises UsageError."""
    if not NAME.fullmatch(name):
        raise UsageError(f"new-method: {name!r} is no name of a method; allowed: small letters and digits, "
                         "words joined by single hyphens, such as my-array")
    folder = template_dir()
    for path in sorted(p for p in folder.rglob("*") if p.is_file() and "__pycache__" not in p.parts):
        yield Path(_renamed(str(path.relative_to(folder)), name)), _renamed(path.read_text(encoding="utf-8"), name)


def _renamed(text: str, name: str) -> str:
    for made, given in ((EXAMPLE, name), (_identifier(EXAMPLE), _identifier(name)), (_title(EXAMPLE), _title(name))):
        text = text.replace(made, given)
    return text


def _identifier(name: str) -> str:
    return name.replace("-", "_")


def _title(name: str) -> str:
    return name.replace("-", " ").capitalize()


def write(name: str, folder: Path) -> list[Path]:
    """Write the package into a folder that is not there yet. Raises UsageError and StoreError."""
    next(files(name))  # the name before the folder, which may be of its name
    if folder.exists():
        raise UsageError(f"new-method: {folder} is there already; allowed: a folder that is not")
    made = []
    for inside, text in files(name):
        path = folder / inside
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        except OSError as error:
            raise StoreError(f"{path}: cannot be written: {error.strerror}; remove {folder}, then run the "
                             "same command again") from None
        made.append(path)
    return made

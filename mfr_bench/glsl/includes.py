"""Shader files with every include in place, and what a driver says of them mapped back to file and line."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache

from ..errors import ShaderError
from ..methods.outside import shader_folders
from ..resources import shaders_dir
from .branches import compiled
from .code import code_of
from .counters import is_counter

LINE_STRIDE = 100_000  # line numbers carry the file: Mesa drops the source number of #line

folders_outside = shader_folders  # replaced in the process that loads a package, which asks no other process

_INCLUDE = re.compile(r'^\s*#include\s+(?:"(?P<path>[^"]+)"|<(?P<slot>\w+)>)\s*$')


@dataclass(frozen=True)
class StageSource:
    """One shader stage: its full text, and the files that its #line numbers refer to."""

    entry: str
    text: str
    files: tuple[str, ...]
    counted: bool = False

    @cached_property
    def code(self) -> str:
        """The text without comments, by which a measured cell knows its shaders."""
        return code_of(self.text)

    @property
    def compiled(self) -> str:
        """The part of the code that the compiler goes on with: stages in which it is the same make the same program."""
        return compiled(self.code)

    def located(self, log: str) -> str:
        """A driver's log with encoded lines as file:line. Mesa writes `0:300014(3):`, NVIDIA `0(300014) :`."""
        def name(match: re.Match[str]) -> str:
            number, line = divmod(int(match["mesa"] or match["nvidia"]), LINE_STRIDE)
            return f"{self.files[number]}:{self._line(number, line)}" if number < len(self.files) else match[0]
        return re.sub(r"^\d+(?::(?P<mesa>\d+)\(\d+\)|\((?P<nvidia>\d+)\)\s?)", name, log, flags=re.MULTILINE)

    def _line(self, number: int, line: int) -> int:
        """The line of a file for a line of its text here, where those that count may be left out."""
        if number == 0 or self.counted:
            return line
        lines = read(self.files[number]).splitlines()
        kept = [at for at, text in enumerate(lines, start=1) if not is_counter(text)]
        return kept[line - 1] if 0 < line <= len(kept) else line


@cache
def read(path: str) -> str:
    """Text of a file below shaders/, or else below the shaders of a package from outside."""
    file = shaders_dir() / path
    if not file.is_file():
        file = next((f for f in (folder / path for folder in folders_outside()) if f.is_file()), file)
    try:
        return file.read_text(encoding="utf-8")
    except OSError as error:
        raise ShaderError(f"{path}: cannot be read: {error.strerror}") from None


@lru_cache(maxsize=512)
def _lines(text: str, counted: bool) -> tuple[tuple[str, re.Match[str] | None], ...]:
    """The lines of a file's text, each with its match as an include; without those that count if nothing is counted."""
    return tuple((line, _INCLUDE.match(line)) for line in text.splitlines() if counted or not is_counter(line))


def expand(entry: str, slots: Mapping[str, str], counted: bool = False,
           behind: Mapping[str, str] | None = None) -> tuple[str, tuple[str, ...]]:
    """Text of `entry` with every include in place, each file once; `#include <slot>` is the method's choice.

    `behind`: files that stand behind others, wherever those are included.
    """
    files: list[str] = ["prelude"]
    lines: list[str] = []

    def add(path: str) -> None:
        if path in files:
            return
        files.append(path)
        number = len(files) - 1
        lines.append(f"#line {number * LINE_STRIDE + 1}")
        for at, (line, match) in enumerate(_lines(read(path), counted), start=1):
            if not match:
                lines.append(line)
                continue
            target = match["path"] or slots.get(match["slot"])
            if target is None:
                raise ShaderError(f"{path}:{at}: the method gives no include for <{match['slot']}>")
            try:
                add(target)
            except ShaderError as error:
                raise ShaderError(f"{path}:{at}: {error}") from None
            lines.append(f"#line {number * LINE_STRIDE + at + 1}")
        if behind and path in behind:
            add(behind[path])

    add(entry)
    return "\n".join(lines) + "\n", tuple(files)

"""Samples of cells that are not done yet: what a killed run has taken is not taken again.

    DIR/unfinished.jsonl    a line per batch, appended as it comes; gone once every cell has its row

A line that was cut off when the process died is no line, and costs its batch alone.
"""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from ..errors import StoreError
from .files import unwritable, write_file
from .record import is_samples


@dataclass
class Partial:
    """Times of a cell's frames and passes so far, in ms, from so many processes."""

    samples_ms: list[float] = field(default_factory=list)
    passes: dict[str, list[float]] = field(default_factory=dict)
    sessions: int = 0


class Journal:
    """The unfinished cells of one result folder. Nothing is written before the first batch."""

    def __init__(self, path: Path):
        self.path = path
        self.partials: dict[str, Partial] = {}
        self._sessions: dict[str, set[str]] = {}
        self._file: Any = None
        self._unsynced = False
        for line in self._lines():
            self._take(line)

    def _lines(self) -> list[dict[str, Any]]:
        try:
            texts = self.path.read_bytes().split(b"\n")
        except FileNotFoundError:
            return []
        except OSError as error:
            raise StoreError(f"{self.path}: cannot be read: {error.strerror}") from error
        found = []
        for text in texts:
            with suppress(ValueError, RecursionError):
                found.append(json.loads(text))
        return [line for line in found if _is_line(line)]

    def _take(self, line: Mapping[str, Any]) -> None:
        if "done" in line:
            self.partials.pop(line["key"], None)
            self._sessions.pop(line["key"], None)
            return
        partial = self.partials.setdefault(line["key"], Partial())
        partial.samples_ms += line["samples_ms"]
        for name, times_ms in line["passes"].items():
            partial.passes.setdefault(name, []).extend(times_ms)
        sessions = self._sessions.setdefault(line["key"], set())
        sessions.add(line["session"])
        partial.sessions = len(sessions)

    def add(self, key: str, session: str, samples_ms: Sequence[float], passes: Mapping[str, Sequence[float]]) -> None:
        """Append a batch; it outlives this process at once, and the machine after `sync`. Raises StoreError."""
        line = {"key": key, "session": session, "samples_ms": list(samples_ms),
                "passes": {name: list(times_ms) for name, times_ms in passes.items()}}
        self._take(line)
        self._unsynced = True
        if self._file is None:
            self._rewrite()  # without what is done, and with an end to a line that was cut off
            self._file = open(self.path, "ab", buffering=0)  # noqa: SIM115 - open until it is closed
        else:
            self._append(line)

    def _append(self, line: Mapping[str, Any]) -> None:
        text = _text(line)
        full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        try:
            failed = full if self._file.write(text) < len(text) else None
        except OSError as error:
            failed = error
        if failed:
            raise StoreError(unwritable(self.path, failed)) from failed

    def sync(self) -> None:
        """Let what was added outlive a loss of power; that cells are done, their rows tell. Raises StoreError."""
        self.syncing()()

    def syncing(self) -> Callable[[], None]:
        """What `sync` has to do now, for whoever has the time, in another thread too."""
        handle = os.dup(self._file.fileno()) if self._file is not None and self._unsynced else None
        self._unsynced = False
        return partial(self._synced, handle)

    def _synced(self, handle: int | None) -> None:
        if handle is None:
            return
        try:
            os.fsync(handle)
        except OSError as error:
            raise StoreError(unwritable(self.path, error)) from error
        finally:
            os.close(handle)

    def forget(self, key: str) -> None:
        """The cell has its row. Raises StoreError."""
        known = key in self.partials
        self._take({"key": key, "done": True})
        if known and self._file is not None and self.partials:
            self._append({"key": key, "done": True})
        if not self.partials:
            self.close()

    def close(self) -> None:
        """Leave what is unfinished, and no file where nothing is."""
        if self._file is not None:
            self._file.close()
            self._file = None
        if not self.partials:
            self.path.unlink(missing_ok=True)

    def _rewrite(self) -> None:
        """A line per cell, and an empty one for each further process that its samples come from."""
        lines = []
        for key, taken in self.partials.items():
            first, *more = sorted(self._sessions[key])
            lines.append({"key": key, "session": first, "samples_ms": taken.samples_ms, "passes": taken.passes})
            lines += [{"key": key, "session": session, "samples_ms": [], "passes": {}} for session in more]
        write_file(self.path, b"".join(map(_text, lines)), durable=True)


def _text(line: Mapping[str, Any]) -> bytes:
    return json.dumps(line).encode() + b"\n"


def _is_line(line: Any) -> bool:
    """Whether it is a usable batch, or says that a cell is done."""
    if not (isinstance(line, dict) and isinstance(line.get("key"), str)):
        return False
    return "done" in line or (
        isinstance(line.get("session"), str) and is_samples(line.get("samples_ms"))
        and isinstance(line.get("passes"), dict) and all(map(is_samples, line["passes"].values())))

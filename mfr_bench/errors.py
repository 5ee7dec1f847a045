"""Errors that a user can act on, each with the exit status that it ends the command with."""

from __future__ import annotations

import difflib
import reprlib
from collections.abc import Iterable
from typing import Any


class MfrError(Exception):
    """Base of every error that ends a command with one clear line instead of a traceback."""

    exit_status = 1


class UsageError(MfrError):
    """The command or the config is wrong. `lines` has one complete message per mistake, none twice."""

    exit_status = 2

    def __init__(self, lines: str | Iterable[str]):
        self.lines = [lines] if isinstance(lines, str) else list(dict.fromkeys(lines))
        super().__init__("\n".join(self.lines))


class DeviceError(MfrError):
    """No usable OpenGL device, or the device was lost."""


class UnknownDeviceError(DeviceError):
    """No device is the one that `--device` names; the message lists those that there are."""

    exit_status = 2


class ShaderError(MfrError):
    """A shader that does not expand, compile or link; the message names file and line."""


class CapacityError(MfrError):
    """The fragments of a frame do not fit the largest buffer that the device gives; the message has their number."""


class StoreError(MfrError):
    """A result folder that cannot be written or read."""


class Interrupted(MfrError):  # noqa: N818 - how a run ended, not what is wrong
    """Ctrl-C; the message says what is kept."""

    exit_status = 130


def shown(value: Any) -> str:
    """A value of a config, short enough for a line."""
    return "nothing" if value is None else _short.repr(value)


def not_allowed(value: Any) -> str:
    """What is wrong with a value that is none of those that are allowed, or that is missing after its key."""
    return "no value is given" if value is None else f"{shown(value)} is not allowed"


_short = reprlib.Repr()
_short.maxstring = _short.maxother = _short.maxlong = 60


def nearest(word: str, allowed: Iterable[str]) -> str:
    """Return '; nearest: X' for the allowed name closest to `word`, or '' where none is close."""
    close = difflib.get_close_matches(word, list(allowed), n=1, cutoff=0.5)
    return f"; nearest: {close[0]!r}" if close else ""


SHORT = 30  # names: of a longer list the nearest stand first, or alone
MOST_NEAR = 3


def one_of(word: str, allowed: Iterable[str], listed_by: str = "") -> str:
    """Return 'allowed: A, B; nearest: B' for a `word` that is none of them. In a long list the nearest stands first.

    listed_by: a command that lists them all. A long list is then left to it, and up to three of the nearest are named.
    """
    names = list(allowed)
    if listed_by and len(names) > SHORT:
        close = ", ".join(map(repr, difflib.get_close_matches(word, names, n=MOST_NEAR, cutoff=0.5)))
        return f"{f'nearest: {close}; ' if close else ''}allowed: any of {len(names)}, which '{listed_by}' lists"
    close, listed = nearest(word, names), f"allowed: {', '.join(names) or 'nothing'}"
    return f"{close.removeprefix('; ')}; {listed}" if close and len(names) > SHORT else listed + close

"""Finds what a bundle must not say: who measured, on which machine by name, in which folders."""

from __future__ import annotations

import getpass
import re
import socket
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..store.record import NODE

PATHS = re.compile(r"(?<![\w./])(?:~|/(?!/)[\w.+-]+|[A-Za-z]:[\\/])[\w.+\-\\/]*[\\/][\w.+\-\\/]*")  # absolute ones
SHORTEST = 3  # letters of a name that is looked for: shorter ones are parts of words
REMOVED = "(removed)"


def names() -> list[str]:
    """The user's name, the machine's, and the user's home folder, as far as there are any worth looking for."""
    try:
        user = getpass.getuser()
    except (KeyError, OSError):
        user = ""
    home = str(Path.home())
    host = socket.gethostname()
    return [name for name in (home, user, host, host.partition(".")[0])
            if len(name) >= SHORTEST and name not in ("root", "localhost", "/root")]


def pattern(found: list[str]) -> re.Pattern[str]:
    """Matches an absolute path, or one of these names as a word."""
    words = [rf"(?<!\w){re.escape(name)}(?!\w)" for name in found]
    return re.compile("|".join([*words, PATHS.pattern]))


def cleaned(value: Any, personal: re.Pattern[str]) -> Any:
    """A JSON value with every personal name and path replaced, and without what identifies a card."""
    if isinstance(value, Mapping):
        return {name: None if name in NODE else cleaned(part, personal) for name, part in value.items()}
    if isinstance(value, list):
        return [cleaned(part, personal) for part in value]
    return personal.sub(REMOVED, value) if isinstance(value, str) else value

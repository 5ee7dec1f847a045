"""The lines of a shader that its compiler sees, with macros that stand for a name replaced."""

from __future__ import annotations

import re

from ..glsl.branches import compiled
from ..glsl.code import code_of

_WORD = re.compile(r"[A-Za-z_]\w*")
_NAMED = re.compile(r"^\s*#\s*define\s+(\w+)\s+([A-Za-z_]\w*)$", re.MULTILINE)


def active(text: str) -> str:
    """The code of a shader in branches that are chosen, or that the compiler alone chooses, with macros replaced."""
    code = compiled(code_of(text))
    names = dict(_NAMED.findall(code))
    return _WORD.sub(lambda match: names.get(match[0], match[0]), code)

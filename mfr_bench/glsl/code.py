"""The code of a shader: what is left when comments, blank lines and `#line` directives are taken out of its text.

Programs with the same code are the same program. The key of a measured cell, the programs that a device keeps, and the
names that the prelude defines all depend on the code alone, so that editing a comment measures nothing again.
"""

from __future__ import annotations

import re

_CONTINUED = re.compile(r"\\\n[ \t]*")
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_POSITION = re.compile(r"^\s*#line\b.*$", re.MULTILINE)


def code_of(text: str) -> str:
    """The text without comments, blank lines, `#line` directives and spaces at line ends; continued lines are joined.

    A comment counts as one space, as GLSL says. GLSL has no strings, so every comment sign begins a comment.
    """
    bare = _POSITION.sub("", _COMMENT.sub(" ", _CONTINUED.sub(" ", text)))
    return "\n".join(line for line in map(str.rstrip, bare.splitlines()) if line)

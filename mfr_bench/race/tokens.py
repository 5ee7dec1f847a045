"""The words of preprocessed GLSL, each with the encoded line that it stands on."""

from __future__ import annotations

import re
from collections.abc import Callable

from ..errors import ShaderError

_TOKEN = re.compile(r"""(?P<marker>^\#\s*(?:line\s+)?(?P<line>\d+)[^\n]*)|(?P<newline>\n)|(?P<space>[ \t\r\f]+)
    |(?P<number>0[xX][0-9a-fA-F]+[uU]?|(?:\d+\.\d*|\.\d+|\d+)(?:[eE][+-]?\d+)?(?:lf|LF|[fFuU])?)
    |(?P<word>[A-Za-z_]\w*)
    |(?P<mark><<=|>>=|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||\^\^|[-+*/%&|^]=|[-+*/%&|^~!<>=?:;,.(){}\[\]])
    |(?P<other>.)""", re.VERBOSE | re.MULTILINE)

Locate = Callable[[int], str]


class Tokens:
    """The tokens of a preprocessed shader, each with its encoded line; `locate` gives file and line for messages."""

    def __init__(self, text: str, locate: Locate):
        self.locate = locate
        self.found: list[tuple[str, str, int]] = []
        line = 1
        for match in _TOKEN.finditer(text):
            kind = match.lastgroup
            if match["marker"]:
                line = int(match["line"]) - 1  # the newline behind the marker counts
            elif kind == "newline":
                line += 1
            elif kind == "other":
                raise ShaderError(f"{locate(line)}: the race machine does not know {match[0]!r}")
            elif kind != "space":
                self.found.append((kind or "", match[0], line))
        self.found.append(("end", "", line))
        self.at = 0

    def __bool__(self) -> bool:
        return self.found[self.at][0] != "end"

    @property
    def text(self) -> str:
        return self.found[self.at][1]

    @property
    def kind(self) -> str:
        return self.found[self.at][0]

    @property
    def line(self) -> int:
        return self.found[self.at][2]

    def ahead(self, by: int) -> str:
        return self.found[min(self.at + by, len(self.found) - 1)][1]

    def take(self) -> str:
        taken = self.text
        self.at = min(self.at + 1, len(self.found) - 1)
        return taken

    def accept(self, text: str) -> bool:
        if self.text == text and self.kind != "end":
            self.at += 1
            return True
        return False

    def expect(self, text: str) -> None:
        if not self.accept(text):
            raise self.unknown(f"wants {text!r} before {self.text!r}")

    def word(self) -> str:
        if self.kind != "word":
            raise self.unknown(f"wants a name before {self.text!r}")
        return self.take()

    def unknown(self, what: str) -> ShaderError:
        return ShaderError(f"{self.locate(self.line)}: the race machine {what}")

"""The lines of a shader that its compiler sees: branches of #if chosen, macros that stand for a name replaced."""

from __future__ import annotations

import re

WORD = re.compile(r"[A-Za-z_]\w*")
DEFINED = re.compile(r"defined\s*\(?\s*(\w+)\s*\)?")


def active(text: str) -> str:
    """The lines of a shader in the branches that are chosen, with those macros replaced."""
    macros: dict[str, str] = {}
    lines: list[str] = []
    stack: list[tuple[bool, bool]] = []  # of each open #if: this branch is active, one of its branches has been
    for line in text.splitlines():
        word, _, rest = line.strip().partition(" ")
        if word in ("#if", "#ifdef", "#ifndef"):
            chosen = rest.strip() in macros if word != "#if" else _holds(rest, macros)
            chosen ^= word == "#ifndef"
            stack.append((chosen, chosen))
        elif word == "#elif":
            _, done = stack.pop()
            chosen = not done and _holds(rest, macros)
            stack.append((chosen, done or chosen))
        elif word == "#else":
            _, done = stack.pop()
            stack.append((not done, True))
        elif word == "#endif":
            stack.pop()
        elif all(chosen for chosen, _ in stack):
            if word == "#define":
                name, _, value = rest.partition(" ")
                macros[name] = value.strip()
            lines.append(line)
    names = {name: value for name, value in macros.items() if WORD.fullmatch(value)}
    return WORD.sub(lambda match: names.get(match[0], match[0]), "\n".join(lines))


def _holds(condition: str, macros: dict[str, str]) -> bool:
    text = DEFINED.sub(lambda match: str(int(match[1] in macros)), condition)
    text = WORD.sub(lambda match: _number(macros.get(match[0], "0")), text)
    text = re.sub(r"!(?!=)", " not ", text).replace("&&", " and ").replace("||", " or ")
    return bool(eval(text))  # noqa: S307  the project's own shaders, numbers and operators by now


def _number(value: str) -> str:
    return value.rstrip("u") if re.fullmatch(r"\d+u?", value) else "0"

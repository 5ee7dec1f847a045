"""The part of a shader's code that its compiler goes on with: the branches of #if that are chosen, the macros in use.

Programs that differ in the rest alone are one program; drivers, which keep programs by their text, do not know that.
"""

from __future__ import annotations

import operator
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache

_WORD = re.compile(r"[A-Za-z_]\w*")
_NUMBER = re.compile(r"(0|[1-9]\d*)[uU]?")
_TOKEN = re.compile(r"\s*(\w+|\|\||&&|[=!<>]=|.)")
_DEFINE = re.compile(r"\s*#\s*define\s+(\w+)(.*)")
_PARAMETERS = re.compile(r"\s*#\s*define\s+\w+\(([^)]*)\)")
_PASTED = re.compile(r"\w+(?:\s*##\s*\w+)+")
_DIRECTIVE = re.compile(r"\s*#\s*(\w+)\s*(.*)")
_OF_THE_COMPILER = ("GL_", "__")  # macros that it may define begin so
_BINARY: Mapping[str, tuple[int, Callable[[int, int], int]]] = {
    "||": (1, lambda a, b: a or b), "&&": (2, lambda a, b: a and b), "==": (3, operator.eq), "!=": (3, operator.ne),
    "<": (4, operator.lt), ">": (4, operator.gt), "<=": (4, operator.le), ">=": (4, operator.ge),
    "+": (5, operator.add), "-": (5, operator.sub), "*": (6, operator.mul),
}


class _Undecided(Exception):  # noqa: N818 - no error
    """What a condition says is known to the compiler alone, or it is written in a way that is not read here."""


@dataclass
class _If:
    """An open #if. kept: the lines of this branch stay. done: no later branch is chosen. stays: its directives do."""

    kept: bool
    done: bool
    stays: bool


@lru_cache(maxsize=2048)
def compiled(code: str) -> str:
    """Code without comments and continued lines, less branches that are not chosen and macros that nothing names.

    All of the code where its branches do not pair, so that the compiler complains of it.
    """
    return "\n".join(_in_use(active_lines(code))) if _pairs(code) else code


def _pairs(code: str) -> bool:
    """Whether each #elif, #else and #endif has an #if, each #if an #endif, and no #else a further branch behind it."""
    ended: list[bool] = []  # of each open #if: whether its #else has been
    for line in code.splitlines():
        match = _DIRECTIVE.match(line)
        word = match[1] if match else ""
        if word in ("if", "ifdef", "ifndef"):
            ended.append(False)
        elif word in ("elif", "else", "endif"):
            if not ended or (word != "endif" and ended[-1]):
                return False
            if word == "endif":
                ended.pop()
            else:
                ended[-1] = word == "else"
    return not ended


def active_lines(text: str) -> list[str]:
    """The lines in branches that are chosen, without the directives of these.

    Where the compiler alone knows which is chosen, as of an extension, all branches stay, with their directives.
    """
    macros: dict[str, str | None] = {}  # None: known to the compiler alone
    lines: list[str] = []
    open_ifs: list[_If] = []
    for line in text.splitlines():
        match = _DIRECTIVE.match(line)
        word, rest = match.groups() if match else ("", "")
        if word == "endif":
            closed = open_ifs.pop()
            lines += [line] * closed.stays
        elif word in ("elif", "else") and open_ifs[-1].stays:
            lines.append(line)
        elif word in ("elif", "else"):
            open_ifs[-1] = _next_branch(open_ifs[-1], rest if word == "elif" else "1", macros, lines)
        elif not all(each.kept for each in open_ifs):
            if word in ("if", "ifdef", "ifndef"):
                open_ifs.append(_If(kept=False, done=True, stays=False))
        elif word in ("if", "ifdef", "ifndef"):
            condition = rest if word == "if" else f"{'!' * (word == 'ifndef')}defined({rest.strip()})"
            open_ifs.append(_next_branch(_If(kept=False, done=False, stays=False), condition, macros, lines))
        else:
            if word in ("define", "undef"):
                _take_in(line, word, rest, macros, sure=not any(each.stays for each in open_ifs))
            lines.append(line)
    return lines


def _next_branch(before: _If, condition: str, macros: Mapping[str, str | None], lines: list[str]) -> _If:
    """The #if at its next branch. One that is not decided begins an #if that stays."""
    try:
        chosen = not before.done and bool(_value(condition, macros))
    except _Undecided:
        lines.append(f"#if {condition}")
        return _If(kept=True, done=True, stays=True)
    return _If(kept=chosen, done=before.done or chosen, stays=False)


def _take_in(line: str, word: str, rest: str, macros: dict[str, str | None], sure: bool) -> None:
    """Note a macro that is defined, or not any more; sure: whether the line is compiled in any case."""
    match = _DEFINE.match(line)
    name = match[1] if match else rest.strip()
    if not sure:
        macros[name] = None
    elif word == "undef":
        macros.pop(name, None)
    else:
        macros[name] = match[2].strip()


def _value(condition: str, macros: Mapping[str, str | None]) -> int:
    tokens = _TOKEN.findall(condition)[::-1]
    found = _operation(tokens, macros, 1)
    if tokens:
        raise _Undecided
    return found


def _operation(tokens: list[str], macros: Mapping[str, str | None], least: int) -> int:
    """The value of the operations from the next token on that bind at least so strongly; takes their tokens away."""
    left = _operand(tokens, macros)
    while tokens and tokens[-1] in _BINARY and _BINARY[tokens[-1]][0] >= least:
        strength, operate = _BINARY[tokens.pop()]
        left = int(operate(left, _operation(tokens, macros, strength + 1)))
    return left


def _operand(tokens: list[str], macros: Mapping[str, str | None]) -> int:
    token = tokens.pop() if tokens else ""
    if token == "!":
        return int(not _operand(tokens, macros))
    if token == "(":
        inner = _operation(tokens, macros, 1)
        if not tokens or tokens.pop() != ")":
            raise _Undecided
        return inner
    if token == "defined":
        inside = [tokens.pop() for _ in range(3 if tokens and tokens[-1] == "(" else 1) if tokens]
        name = inside[len(inside) // 2] if inside else ""
        if not _WORD.fullmatch(name) or inside not in ([name], ["(", name, ")"]):
            raise _Undecided
        return int(_known(name, macros) is not None)
    if _WORD.fullmatch(token):
        known = _known(token, macros)
        token = "0" if known is None else known
    if not _NUMBER.fullmatch(token):
        raise _Undecided
    return int(token.rstrip("uU"))


def _known(name: str, macros: Mapping[str, str | None]) -> str | None:
    """The text of a macro; None where there is none."""
    if name not in macros and not name.startswith(_OF_THE_COMPILER):
        return None
    if macros.get(name) is None:
        raise _Undecided
    return macros[name]


def _in_use(lines: Iterable[str]) -> list[str]:
    """The lines less definitions of macros that no other line names, nor makes by ##."""
    lines = list(lines)
    pasted = [literals for line in lines if "##" in line for literals in _pasted(line)]
    words = {at: (line, _WORD.findall(line)) for at, line in enumerate(lines)}
    named = Counter(word for _, found in words.values() for word in set(found))
    defined = {at: match[1] for at, (line, _) in words.items() if (match := _DEFINE.match(line))
               and not any(all(part in match[1] for part in literals) for literals in pasted)}
    while unused := [at for at, name in defined.items() if named[name] == 1]:
        for at in unused:
            named.subtract(set(words.pop(at)[1]))
            del defined[at]
    return [line for line, _ in words.values()]


def _pasted(line: str) -> list[list[str]]:
    """The parts that are no parameters, of each name that the line's macro makes by ##."""
    match = _PARAMETERS.match(line)
    parameters = set(_WORD.findall(match[1])) if match else set()
    return [[part for part in re.split(r"\s*##\s*", name) if part not in parameters]
            for name in _PASTED.findall(line)]

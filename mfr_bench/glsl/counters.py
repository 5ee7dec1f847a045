"""Shader text that counts its work: accesses to storage by their words, atomics, fragments stored, read and moved.

What a buffer access costs is counted in the expression that indexes it, so that every method is counted without a word
of its own. What only the shader can tell, such as tries for a lock, stands there as a line `COUNT(name, amount)` or
`COUNT_MOST(name, amount)`; such lines are no part of the programs that are timed.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from ..errors import ShaderError

# Counters of 64 bits, in this order behind the diagnostics. Each is a number of …
WORK: Mapping[str, str] = {
    "invocations": "shader invocations: fragments of a geometry pass, pixels of a full-screen pass, else threads",
    "refused": "fragments that did not ask for the lock: not generated, or known to be too far",
    "entered": "fragments that asked for the lock, or were stored without it",
    "hidden": "fragments dropped behind the opacity before them",
    "stored": "elements written that hold a fragment, or one of its two halves",
    "loaded": "elements read that hold a fragment, or one of its two halves",
    "moved": "fragments that a resolve wrote into its local array or swapped in registers",
    "atomics": "atomic operations",
    "spins": "tries for a lock beyond the first",
    "longest_wait": "tries of the fragment that waited longest, beyond the first",
    "words_read": "32-bit words read from buffers and textures, those of atomics included",
    "words_written": "32-bit words written to buffers, those of atomics included",
    "empty": "pixels resolved that had no fragment",
}
MOST = ("longest_wait",)  # the others are sums

_LINE = re.compile(r"^(?P<indent>\s*)COUNT(?P<most>_MOST)?\((?P<name>\w+), (?P<amount>.*)\)(?P<end>\s*\\?)$")
_ALIAS = re.compile(r"^#define (\w+) (\w+)$", re.MULTILINE)
_ACCESSOR = re.compile(r"^#define (\w+)\([^)]*\) (\w+)(\[.*\])(?:\s*//.*)?$", re.MULTILINE)
_ATOMIC = re.compile(r"\batomic\w+\(\s*$")
_DECLARED = re.compile(r"\b(?:FRAGMENT|uvec2|uint|vec4)\s+$")
_FETCH = re.compile(r"\btexelFetch\(\s*(\w+)\s*,\s*")
_WRITE = re.compile(r"\s*(?:\.[xyz]\s*)?=(?!=)")
_BOTH = re.compile(r"\s*(?:\.[xyz]\s*)?(?:[-+|&^]=|\+\+|--)")
_PART = re.compile(r"\s*\.[xyz]\b")
LOCAL_ARRAY = "fragments"  # in common/local.glsl

ADD_WORK = """
void add_work(uint kind, uint amount) {
    uint before = atomicAdd(work[2u * kind], amount);
    if (before + amount < before) atomicAdd(work[2u * kind + 1u], 1u);
}
"""
AT_ONCE = ADD_WORK + "#define count_work(kind, amount) add_work(kind, amount)\n"
# The sums of an invocation, in registers, are added when it ends: a sorting network counts at hundreds of places, each
# of which would be an atomic operation to compile.
SUMMED = f"{ADD_WORK}uint summed[{len(WORK)}];\n#define count_work(kind, amount) summed[kind] += (amount)\n"
MAIN = "void main() {"
_ENDS_EARLY = re.compile(r"\bdiscard\b|InvocationInterlock")  # before the end of main, or in no other function

FUNCTIONS = """
#define COUNTED(T) \\
T reads(T at, uint words, uint holds) {{ \\
    count_work({words_read}u, words); if (holds > 0u) count_work({loaded}u, 1u); return at; }} \\
T writes(T at, uint words, uint holds) {{ \\
    count_work({words_written}u, words); if (holds > 0u) count_work({stored}u, 1u); return at; }} \\
T changes(T at, uint words, uint holds) {{ \\
    count_work({words_read}u, words); count_work({words_written}u, words); return at; }} \\
T swaps(T at, uint words, uint holds) {{ count_work({atomics}u, 1u); return changes(at, words, holds); }} \\
T moves(T at) {{ count_work({moved}u, 1u); return at; }}
COUNTED(uint)
COUNTED(int)
ivec2 reads(ivec2 at, uint words, uint holds) {{ count_work({words_read}u, words); return at; }}
ivec3 reads(ivec3 at, uint words, uint holds) {{ count_work({words_read}u, words); return at; }}
""".format(**{name: index for index, name in enumerate(WORK)})


@dataclass(frozen=True)
class Stored:
    """A buffer's elements, or a texture's texels: their words, and whether each stores a fragment."""

    words: int
    holds: bool = False


def is_counter(line: str) -> bool:
    """Whether the line of a shader only counts."""
    return _LINE.match(line) is not None


def counting(prelude: str, body: str, storage: Mapping[str, Stored]) -> str:
    """The shader with its counters in place; `storage` is what it may access, by name.

    The body holds its lines `COUNT(…)` still. Raises ShaderError for a counter that WORK does not have.
    """
    body = "\n".join(map(_counted_line, body.splitlines())) + "\n"
    names = dict(storage) | {alias: storage[name] for alias, name in _ALIAS.findall(body) if name in storage}
    accessors = {macro: names[name] for macro, name, _ in _ACCESSOR.findall(f"{prelude}\n{body}")
                 if name in names}
    accesses = _Accesses(names, accessors)
    summed = MAIN in body and not _ENDS_EARLY.search(body)
    main = "void main_counted() {" if summed else MAIN
    body = body.replace(MAIN, f"{main} count_work({_index('invocations')}u, 1u);")
    text = accesses.rewritten(prelude + "\n") + (SUMMED if summed else AT_ONCE) + FUNCTIONS + accesses.rewritten(body)
    return text + _summing_main() if summed else text


def _summing_main() -> str:
    """The main function around that of a shader, which adds up what an invocation counts."""
    each = range(len(WORK))
    begin = " ".join(f"summed[{kind}] = 0u;" for kind in each)
    end = " ".join(f"if (summed[{kind}] > 0u) add_work({kind}u, summed[{kind}]);" for kind in each)
    return f"{MAIN} {begin} main_counted(); {end} }}\n"


def mapped(prelude: str, body: str, name: str) -> str | None:
    """The shader with one counter of its lines `COUNT(…)` kept for each pixel, in `work`; None where it has no such."""
    if not any(match["name"] == name for match in map(_LINE.match, body.splitlines()) if match):
        return None
    return prelude + "\n" + "\n".join(_mapped_line(line, name) for line in body.splitlines()) + "\n"


def _mapped_line(line: str, name: str) -> str:
    match = _LINE.match(line)
    if not match:
        return line
    call = f"if (bool({match['amount']})) atomicAdd(work[pixel_index()], 1u);" if match["name"] == name else ""
    return f"{match['indent']}{call}{match['end']}"


def _index(name: str) -> int:
    if name not in WORK:
        raise ShaderError(f"no counter {name!r}; allowed: {', '.join(WORK)}")
    return list(WORK).index(name)


def _counted_line(line: str) -> str:
    match = _LINE.match(line)
    if not match:
        return line
    index, amount = _index(match["name"]), match["amount"]
    call = f"atomicMax(work[{2 * index}], uint({amount}));" if match["most"] else \
        f"count_work({index}u, uint({amount}));"
    return f"{match['indent']}{call}{match['end']}"


class _Accesses:
    """Rewrites every access to the storage so that its index counts it."""

    def __init__(self, names: Mapping[str, Stored], accessors: Mapping[str, Stored]):
        self.names, self.accessors = names, accessors
        words = "|".join(map(re.escape, sorted({*names, LOCAL_ARRAY})))
        macros = "|".join(map(re.escape, sorted(accessors))) or "(?!)"
        self.found = re.compile(rf"(?P<buffer>\b(?:{words})\[)|(?P<macro>\b(?:{macros})\()|(?P<fetch>{_FETCH.pattern})")

    def _defining(self, text: str) -> set[int]:
        """The lines that define accessors, and each accessor with what it stands for: its uses are counted."""
        return {match.start(group) for match in _ACCESSOR.finditer(text) if match[2] in self.names for group in (1, 2)}

    def rewritten(self, text: str) -> str:
        out: list[str] = []
        at = 0
        while match := self.found.search(text, at):
            out.append(text[at:match.end()])
            if match["fetch"]:
                end = _argument_end(text, match.end())
                out.append(self._fetched(text[match.end():end], match))
            else:
                end = _closing(text, match.end())
                out.append(self._indexed(text, match, end))
            at = end
        return "".join(out) + text[at:]

    def _fetched(self, coordinate: str, match: re.Match[str]) -> str:
        name = _FETCH.match(match["fetch"])[1]
        inner = self.rewritten(coordinate)
        return f"reads({inner}, {self.names[name].words}u, 0u)" if name in self.names else inner

    def _indexed(self, text: str, match: re.Match[str], end: int) -> str:
        """The text in the brackets, or between those of a macro, counted by what is done with the element."""
        inner = self.rewritten(text[match.end():end])
        before, after = text[max(0, match.start() - 40):match.start()], text[end + 1:end + 20]
        name = match[0][:-1]
        if not inner.strip() or _DECLARED.search(before) or match.start() in self._defining(text):
            return inner
        if name == LOCAL_ARRAY:
            return f"moves({inner})" if _WRITE.match(after) else inner
        stored = self.accessors[name] if match["macro"] else self.names[name]
        words = 1 if _PART.match(after) else stored.words
        action = ("swaps" if _ATOMIC.search(before) else "changes" if _BOTH.match(after)
                  else "writes" if _WRITE.match(after) else "reads")
        first, comma, rest = _first_argument(inner) if match["macro"] else (inner, "", "")
        return f"{action}({first}, {words}u, {int(stored.holds)}u){comma}{rest}"


def _closing(text: str, start: int) -> int:
    """Index of the bracket that closes the one before `start`."""
    depth = 1
    for at in range(start, len(text)):
        depth += (text[at] in "([") - (text[at] in ")]")
        if depth == 0:
            return at
    raise ShaderError("a bracket is never closed")


def _argument_end(text: str, start: int) -> int:
    """Index of the comma or bracket behind the argument that starts at `start`."""
    depth = 0
    for at in range(start, len(text)):
        if depth == 0 and text[at] in ",)":
            return at
        depth += (text[at] in "([") - (text[at] in ")]")
    raise ShaderError("an argument never ends")


def _first_argument(text: str) -> tuple[str, str, str]:
    end = _argument_end(text + ")", 0)
    return text[:end], text[end:end + 1], text[end + 1:]

"""C++ for types and expressions, in which every access to memory is a call of the machine."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from ..errors import ShaderError
from .syntax import (
    Assignment,
    Binary,
    Call,
    Choice,
    Expression,
    Index,
    Length,
    Member,
    Name,
    Number,
    Shader,
    Type,
    Unary,
)

SCALARS = {"void": "void", "bool": "bool", "int": "int", "uint": "Uint", "float": "float", "uint64_t": "U64",
           "int64_t": "U64"}  # of 64 bits only the bits count: no shader adds or compares signed ones
PREFIXES = {"": "float", "u": "Uint", "i": "int", "b": "bool"}
ATOMICS = {"atomicAdd": "ADD", "atomicAnd": "AND", "atomicOr": "OR", "atomicXor": "XOR", "atomicMin": "MIN",
           "atomicMax": "MAX", "atomicExchange": "EXCHANGE", "atomicCompSwap": "SWAP"}
FENCES = {"memoryBarrier": "memory_barrier", "memoryBarrierBuffer": "memory_barrier",
          "groupMemoryBarrier": "memory_barrier", "memoryBarrierShared": "memory_barrier", "barrier": "work_barrier",
          "beginInvocationInterlockARB": "interlock_begin", "endInvocationInterlockARB": "interlock_end",
          "beginInvocationInterlockNV": "interlock_begin", "endInvocationInterlockNV": "interlock_end",
          "beginFragmentShaderOrderingINTEL": "interlock_begin"}
INTERLOCKS = {name for name, call in FENCES.items() if call == "interlock_begin"}
BUILT_IN = frozenset(
    {"exp", "exp2", "log", "log2", "sqrt", "inversesqrt", "floor", "ceil", "fract", "round", "trunc", "sin", "cos",
     "abs", "sign", "pow", "min", "max", "clamp", "mix", "dot", "length", "lessThan", "lessThanEqual", "greaterThan",
     "greaterThanEqual", "equal", "notEqual", "all", "any", "floatBitsToUint", "uintBitsToFloat", "findMSB", "findLSB",
     "bitCount", "packUnorm4x8", "unpackUnorm4x8", "packHalf2x16", "unpackHalf2x16", "packUint2x32", "unpackUint2x32",
     "packInt2x32", "unpackInt2x32"})
UNIFORMS = {name: name.upper() for name in (
    "width", "height", "pixels", "capacity", "seed", "keep_threshold", "chosen_k", "region_first", "region_columns",
    "region_pixels", "region_left", "region_bottom", "region_right", "region_top", "box_near", "box_far", "iteration")}
INPUTS = {"quad": "inputs().quad", "payload8": "inputs().payload", "instance": "inputs().instance"}
WRITTEN = ("gl_FragDepth", "gl_SampleMask", "gl_SampleMaskIn")
GIVEN = {
    "true": "true",
    "false": "false",
    "base_a": "base_colour(0)",
    "base_b": "base_colour(1)",
    **{name: f"Uint({value})" for name, value in INPUTS.items()},
    "gl_FragCoord": "V4<float>{float(inputs().x) + 0.5f, float(inputs().y) + 0.5f, inputs().z, 1.0f}",
    "gl_HelperInvocation": "inputs().helper",
    "gl_WorkGroupID": "V3<Uint>{Uint(inputs().group), Uint(0u), Uint(0u)}",
    "gl_NumWorkGroups": "V3<Uint>{Uint(inputs().groups), Uint(1u), Uint(1u)}",
    "gl_LocalInvocationID": "V3<Uint>{Uint(inputs().local_x), Uint(inputs().local_y), Uint(0u)}",
    "gl_LocalInvocationIndex": "Uint(inputs().local_index)",
    "gl_WorkGroupSize": "V3<Uint>{Uint(uint32_t(local_x)), Uint(uint32_t(local_y)), Uint(1u)}",
    "gl_GlobalInvocationID": "V3<Uint>{Uint(inputs().group * uint32_t(local_x) + inputs().local_x), "
                             "Uint(inputs().local_y), Uint(0u)}",
}
LENGTH = "_length"  # of a buffer, as a uniform of its own
COUNTER = "atomic_uint"  # the type of an atomic counter, a word of memory
SETS = "xyzw", "rgba", "stpq"


@dataclass(frozen=True)
class Buffered:
    """The meaning of a name that is memory: a slot, the element's type, and for a single word its place."""

    slot: str
    element: str  # in C++
    part: str  # of the element, in C++
    word: int | None = None


@dataclass
class Sites:
    """The accesses of all passes, by number: the pass, and the encoded line."""

    found: list[tuple[int, int]] = field(default_factory=list)

    def add(self, step: int, line: int) -> int:
        self.found.append((step, line))
        return len(self.found) - 1


@dataclass(frozen=True)
class Stage:
    """The facts about a stage that the translator needs in addition to its text."""

    number: int  # of the pass
    slots: Mapping[str, int]  # by the name of a storage buffer in this pass
    units: Mapping[str, int]  # by the name of a sampler
    locations: Mapping[str, int]  # by the name of an output or image
    concurrent: bool  # whether its invocations run at the same time


def is_swizzle(name: str) -> bool:
    return len(name) <= 4 and any(set(name) <= set(letters) for letters in SETS)


def places(name: str) -> list[int]:
    letters = next(letters for letters in SETS if set(name) <= set(letters))
    return [letters.index(letter) for letter in name]


class Values:
    """Translates the types and expressions of one stage."""

    def __init__(self, shader: Shader, stage: Stage, sites: Sites, locate: Callable[[int], str]):
        self.shader, self.stage, self.sites, self.locate = shader, stage, sites, locate
        self.structs = {s.name: s for s in shader.structs}
        self.members = {name for s in shader.structs for name, _ in s.members}
        self.functions = {f.name for f in shader.functions}
        self.samplers: dict[str, str] = {}
        self.scopes: list[set[str]] = []
        self.memory: dict[str, Buffered] = {}
        self.globals = {g.variable.name for g in shader.globals}
        self.ids = 0
        self.loops: list[int] = []
        self.function_id = -1
        self.in_main = False
        self.uses = set()
        self._find_memory()

    def _find_memory(self) -> None:
        for block in self.shader.blocks:
            if block.kind != "buffer":
                continue
            runtime = [name for name, kind in block.members if kind.lengths]
            for word, (name, kind) in enumerate(block.members):
                slot = self.stage.slots[runtime[0] if runtime and len(block.members) == 1 else name]
                self.memory[name] = Buffered(str(slot), self.type(kind.name), self._part(kind.name),
                                             None if kind.lengths else word)
        for counter in self.shader.globals:
            name = counter.variable.name
            if counter.variable.type.name == COUNTER and name in self.stage.slots:
                self.memory[name] = Buffered(str(self.stage.slots[name]), "Uint", "Uint", 0)
        shared = [g for g in self.shader.globals if "shared" in g.qualifiers]
        for i, variable in enumerate(shared):
            kind = variable.variable.type
            self.memory[variable.variable.name] = Buffered(f"race::SHARED_SLOT + {i}", self.type(kind.name),
                                                           self._part(kind.name))
        if len(shared) > 1:
            raise self.unknown(shared[1].line, "more than one shared variable")

    def _part(self, name: str) -> str:
        return PREFIXES[name[:-4]] if name[:-1].endswith("vec") else "Uint" if name in self.structs else self.type(name)

    def unknown(self, line: int, what: str) -> ShaderError:
        return ShaderError(f"{self.locate(line)}: the race machine does not know {what}")

    # ---- types

    def type(self, name: str) -> str:
        if name in SCALARS:
            return SCALARS[name]
        if name[:-1].endswith("vec"):
            return f"V{name[-1]}<{PREFIXES[name[:-4]]}>"
        return f"T_{name}" if name in self.structs else name

    def full(self, kind: Type) -> str:
        made = self.type(kind.name)
        for length in reversed(kind.lengths):
            made = f"Array<{made}, {self.constant(length)}>"
        return made

    def constant(self, expression: Expression | None) -> str:
        """A whole number that C++ knows when it compiles."""
        match expression:
            case Number(text=text):
                return text.rstrip("uU")
            case Name(name=name):
                return f"u_{name}"
            case Binary(operator=operator, left=left, right=right):
                return f"({self.constant(left)} {operator} {self.constant(right)})"
            case Call(name=name, arguments=(one,)) if name in ("int", "uint"):
                return self.constant(one)
            case Call(name="min" | "max" as name, arguments=(one, two)):
                sign = "<" if name == "min" else ">"
                a, b = self.constant(one), self.constant(two)
                return f"({a} {sign} {b} ? {a} : {b})"
        raise self.unknown(expression.line if expression else 0, "this length of an array")

    # ---- expressions

    def _is_local(self, name: str) -> bool:
        return any(name in scope for scope in self.scopes)

    def buffered(self, e: Expression) -> tuple[Buffered, str, str | None] | None:
        """The memory that is meant: what it is, its index in C++, and the member of the element."""
        match e:
            case Index(base=Name(name=name), index=index) if name in self.memory and not self._is_local(name):
                return self.memory[name], f"Uint({self.value(index)})", None
            case Name(name=name) if name in self.memory and not self._is_local(name):
                found = self.memory[name]
                if found.word is None:
                    raise self.unknown(e.line, f"the array {name!r} as a whole")
                return found, f"Uint({found.word}u)", None
            case Member(base=base, name=member):
                inner = self.buffered(base)
                if inner and inner[2] is None and len(member) == 1:
                    return inner[0], inner[1], member
        return None

    def _site(self, line: int) -> int:
        return self.sites.add(self.stage.number, line)

    def _load(self, found: tuple[Buffered, str, str | None], line: int) -> str:
        where, index, member = found
        if member:
            where_part = f"{where.slot}, {index}, {places(member)[0]}, {self._site(line)}"
            return f"race::load_part<{where.element}, {where.part}>({where_part})"
        return f"race::load<{where.element}>({where.slot}, {index}, {self._site(line)})"

    def _store(self, found: tuple[Buffered, str, str | None], value: str, line: int) -> str:
        where, index, member = found
        if member:
            where_part = f"{where.slot}, {index}, {places(member)[0]}, {value}, {self._site(line)}"
            return f"race::store_part<{where.element}, {where.part}>({where_part})"
        return f"race::store<{where.element}>({where.slot}, {index}, {value}, {self._site(line)})"

    def value(self, e: Expression) -> str:
        """The expression in C++."""
        found = self.buffered(e)
        if found:
            return self._load(found, e.line)
        made = {Number: self._number, Name: self._name, Binary: self._binary, Choice: self._choice, Index: self._index,
                Member: self._member, Length: self._length, Unary: self._unary, Assignment: self._assign,
                Call: self._call}.get(type(e))
        if made is None:
            raise self.unknown(e.line, type(e).__name__)
        return made(e)

    def _number(self, e: Number) -> str:
        text = e.text
        if text[-1] in "uU":
            return f"Uint({text.rstrip('uU')}u)"
        if text.lower().startswith("0x"):
            return f"int({text}u)"
        real = any(c in text for c in ".eE") or text[-1] in "fF"
        return f"{text.rstrip('fFlL')}f" if real else text

    def _binary(self, e: Binary) -> str:
        left, right = self.value(e.left), self.value(e.right)
        if e.operator == "^^":
            return f"(bool({left}) != bool({right}))"
        return f"({left} {e.operator} {right})"

    def _choice(self, e: Choice) -> str:
        return f"({self.value(e.condition)} ? {self.value(e.then)} : {self.value(e.otherwise)})"

    def _index(self, e: Index) -> str:
        return f"element({self.value(e.base)}, {self.value(e.index)}, {self._site(e.line)})"

    def _name(self, e: Name) -> str:
        name, buffer = e.name, e.name.removesuffix(LENGTH)
        if self._is_local(name):
            return f"u_{name}"
        if buffer != name and buffer in self.memory:
            return f"block_length({self.memory[buffer].slot}, race::Words<{self.memory[buffer].element}>::count)"
        if (name in UNIFORMS and name not in self.globals) or name == "iteration":
            return f"Uint(uniform(race::{UNIFORMS[name]}))"
        if name in GIVEN:
            return GIVEN[name]
        if name in WRITTEN:
            self.uses.add(name)
            return name
        if name not in self.globals:
            raise self.unknown(e.line, f"the name {name!r}")
        return f"u_{name}"

    def _member(self, e: Member) -> str:
        base, name = self.value(e.base), e.name
        if not is_swizzle(name):
            if name in self.members:
                return f"({base}).{name}"
            raise self.unknown(e.line, f"the member {name!r}")
        if len(name) == 1:
            return f"({base}).{'xyzw'[places(name)[0]]}"
        return f"swizzle<{', '.join(map(str, places(name)))}>({base})"

    def _length(self, e: Length) -> str:
        base = e.base
        if isinstance(base, Name) and base.name in self.memory and not self._is_local(base.name):
            where = self.memory[base.name]
            return f"int(block_length({where.slot}, race::Words<{where.element}>::count).v)"
        return f"array_length({self.value(base)})"

    def _unary(self, e: Unary) -> str:
        found = self.buffered(e.operand) if e.operator in ("++", "--") else None
        if found:
            return self._updated(found, e.operator[0], "Uint(1u)", e.line, old=e.postfix)
        operand = self.value(e.operand)
        return f"({operand}{e.operator})" if e.postfix else f"({e.operator}{operand})"

    def _updated(self, found: tuple[Buffered, str, str | None], operator: str, value: str, line: int,
                 old: bool = False) -> str:
        where, index, member = found
        at = (where, "at", member)
        result = "was" if old else "now"
        return (f"[&] {{ Uint at = {index}; auto was = {self._load(at, line)}; auto now = was {operator} {value}; "
                f"{self._store(at, 'now', line)}; return {result}; }}()")

    def _assign(self, e: Assignment) -> str:
        found = self.buffered(e.target)
        if found:
            value = self.value(e.value)
            if e.operator == "=":
                return self._store(found, value, e.line)
            return self._updated(found, e.operator[:-1], f"({value})", e.line)
        value = self.value(e.value)
        match e.target:
            case Member(base=base, name=name) if is_swizzle(name) and len(name) > 1:
                if e.operator != "=":
                    raise self.unknown(e.line, f"{e.operator!r} of several components")
                return f"places<{', '.join(map(str, places(name)))}>({self.value(base)}) = {value}"
        if e.operator == "=" and isinstance(e.target, Name):
            return f"assign({self.value(e.target)}, {value})"
        return f"({self.value(e.target)} {e.operator} {value})"

    def _call(self, e: Call) -> str:
        name = e.name
        if name == "atomicCounterIncrement":
            name, e = "atomicAdd", Call(e.line, "atomicAdd", (*e.arguments, Number(e.line, "1u")))
        if name in ATOMICS:
            return self._atomic(e)
        if name in FENCES:
            self.uses.add(name)
            return f"race::{FENCES[name]}({self._site(e.line)})"
        if name == "texelFetch":
            return self._fetch(e)
        arguments = ", ".join(map(self.value, e.arguments))
        if name == "imageStore":
            location = self.stage.locations[e.arguments[0].name]
            return f"race::put_texel({location}, {', '.join(map(self.value, e.arguments[1:]))})"
        if e.array:
            return f"array_of<{self.type(name)}>({arguments})"
        if name in self.functions:
            return f"u_{name}({arguments})"
        if name in SCALARS or name[:-1].endswith("vec") or name in self.structs:
            return f"make<{self.type(name)}>({arguments})"
        if name not in BUILT_IN:
            raise self.unknown(e.line, f"the function {name!r}")
        return f"glsl::{name}({arguments})"

    def _atomic(self, e: Call) -> str:
        found = self.buffered(e.arguments[0])
        if found is None:
            raise self.unknown(e.line, f"{e.name} on what is no storage buffer")
        where, index, member = found
        at = index
        if member:
            at = f"{index} * Uint(uint32_t(race::Words<{where.element}>::count)) + Uint({places(member)[0]}u)"
        values = ", ".join(f"make<{where.part}>({self.value(a)})" for a in e.arguments[1:])
        return f"race::atomic(race::{ATOMICS[e.name]}, {where.slot}, {at}, {values}, {self._site(e.line)})"

    def _fetch(self, e: Call) -> str:
        sampler = e.arguments[0]
        if not isinstance(sampler, Name) or sampler.name not in self.stage.units:
            raise self.unknown(e.line, "this texture")
        kind = next(g.variable.type.name for g in self.shader.globals if g.variable.name == sampler.name)
        sample = self.value(e.arguments[2]) if "MS" in kind else "0"
        reading = "texel_uint" if kind.startswith("u") else "texel_float"
        return f"race::{reading}({self.stage.units[sampler.name]}, {self.value(e.arguments[1])}, int({sample}))"

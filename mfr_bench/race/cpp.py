"""C++ for one stage of a pass.

A stage becomes a struct: its global variables are members, its functions member functions. Each access has a site, a
number by which a trace finds its line again. `branch` and `Join` mark where lanes of a warp part and meet.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

from .syntax import (
    Block,
    Declaration,
    Evaluate,
    Expression,
    Function,
    Global,
    If,
    Jump,
    Loop,
    Shader,
    Statement,
    Variable,
)
from .values import INPUTS, INTERLOCKS, LENGTH, SCALARS, UNIFORMS, Sites, Stage, Values


def translate(shader: Shader, stage: Stage, sites: Sites, locate: Callable[[int], str]) -> str:
    """The struct `Shader<number>` and the function `run<number>`. Raises ShaderError for an unknown construct."""
    return _Translator(shader, stage, sites, locate).text()


class _Translator(Values):
    # ---- the stage

    def text(self) -> str:
        number = self.stage.number
        local = dict(self.shader.inputs)
        sizes = [self.constant(local[f"local_size_{axis}"]) if local.get(f"local_size_{axis}") else "1"
                 for axis in "xy"]
        shared = next((g.variable.type for g in self.shader.globals if "shared" in g.qualifiers), None)
        words = self.constant(shared.lengths[0]) if shared else "0"
        functions = [line for f in self.shader.functions for line in self._function(f)]
        return "\n".join([
            f"namespace pass{number} {{", *(line for s in self.shader.structs for line in self._struct(s)),
            f"constexpr int local_x = {sizes[0]}, local_y = {sizes[1]}, shared_words = {words};", "struct Stage {",
            *self._globals(), *functions, "};", *self._interlock(local), "void run() {", "    Stage stage;",
            "    stage.u_main();", *self._results(), "}", "}"])

    def _interlock(self, inputs: Mapping[str, object]) -> Iterator[str]:
        """Whether invocations pass through an interlock, and whether they do so in the order of submission."""
        ordered = "beginFragmentShaderOrderingINTEL" in self.uses or any("interlock_ordered" in name for name in inputs)
        yield (f"constexpr bool interlocked = {'true' if self.uses & INTERLOCKS else 'false'}, "
               f"ordered = {'true' if ordered else 'false'};")

    def _struct(self, struct) -> Iterator[str]:
        name, members = f"T_{struct.name}", [(n, self.full(t)) for n, t in struct.members]
        if any(kind != "Uint" for _, kind in members):
            raise self.unknown(0, f"the struct {struct.name}, whose members are not all uint")
        count = len(members)
        yield f"struct {name} {{"
        yield "    Uint " + ", ".join(n for n, _ in members) + ";"
        yield f"    {name}() = default;"
        yield f"    {name}({', '.join(f'Uint a{i}' for i in range(count))}) : " + \
              ", ".join(f"{n}(a{i})" for i, (n, _) in enumerate(members)) + " {}"
        yield f"    bool operator==(const {name}& o) const {{ return " + \
              " && ".join(f"{n} == o.{n}" for n, _ in members) + "; }"
        yield f"    bool operator!=(const {name}& o) const {{ return !(*this == o); }}"
        yield "};"
        yield "}"
        yield f"namespace race {{ template <> struct Words<pass{self.stage.number}::{name}> {{"
        yield f"    using T = pass{self.stage.number}::{name}; static constexpr int count = {count};"
        yield f"    static T from(const Uint* w) {{ return T({', '.join(f'w[{i}]' for i in range(count))}); }}"
        yield "    static void to(Uint* w, const T& a) { " + \
              " ".join(f"w[{i}] = a.{n};" for i, (n, _) in enumerate(members)) + " } }; }"
        yield f"namespace pass{self.stage.number} {{"

    def _globals(self) -> Iterator[str]:
        for g in self.shader.globals:
            kind, name = g.variable.type, g.variable.name
            if name in self.memory and "shared" not in g.qualifiers:
                continue
            if "sampler" in kind.name:
                self.samplers[name] = kind.name
            elif "image" in kind.name or "shared" in g.qualifiers or g.qualifiers & {"in", "uniform"}:
                if g.qualifiers & {"in", "uniform"} and not self._is_given(name) and "image" not in kind.name:
                    raise self.unknown(g.line, f"the input or uniform {name!r}")
            elif "inout" in g.qualifiers:
                yield f"{self.full(kind)} u_{name} = {self._fetched(g)};"
            elif "const" in g.qualifiers and kind.name == "int" and not kind.lengths:
                yield f"static constexpr int u_{name} = {self.constant(g.variable.value)};"
            else:
                yield self._global(g.variable)
        yield "float gl_FragDepth = inputs().z; bool wrote_depth = false;"
        yield "Array<int, 1> gl_SampleMask{{-1}}; Array<int, 1> gl_SampleMaskIn{{inputs().helper ? 0 : 1}};"

    def _fetched(self, g: Global) -> str:
        """The value of an output that starts as the fragment before has left the pixel."""
        kind = {"vec4": "float", "uvec4": "uint"}.get(g.variable.type.name)
        if kind is None or g.variable.type.lengths or g.variable.name not in self.stage.locations:
            raise self.unknown(g.line, f"the fetched output {g.variable.name!r}, which is no vec4 or uvec4 of the pass")
        return f"race::fetched_{kind}({self.stage.locations[g.variable.name]})"

    def _is_given(self, name: str) -> bool:
        """Whether the machine gives an input or uniform of this name."""
        of_buffer = name.endswith(LENGTH) and name.removesuffix(LENGTH) in self.memory
        return of_buffer or name in INPUTS or name in UNIFORMS

    def _global(self, variable: Variable) -> str:
        value = f" = {self._converted(variable)}" if variable.value else "{}"
        return f"{self.full(variable.type)} u_{variable.name}{value};"

    def _results(self) -> Iterator[str]:
        for g in self.shader.globals:
            name = g.variable.name
            if not g.qualifiers & {"out", "inout"} or name not in self.stage.locations:
                continue
            location, kind = self.stage.locations[name], g.variable.type
            if kind.lengths:
                yield (f"    for (int i = 0; i < {self.constant(kind.lengths[0])}; ++i) "
                       f"race::put_output({location} + i, stage.u_{name}.items[i]);")
            else:
                yield f"    race::put_output({location}, stage.u_{name});"
        if "gl_FragDepth" in self.uses:
            yield "    outputs().has_depth = true; outputs().depth = stage.gl_FragDepth;"
        if "gl_SampleMask" in self.uses:
            yield "    outputs().mask = uint32_t(stage.gl_SampleMask.items[0]);"

    @contextmanager
    def _scope(self, names: set[str] | None = None):
        self.scopes.append(names or set())
        yield
        self.scopes.pop()

    def _function(self, f: Function) -> Iterator[str]:
        self.ids += 1
        self.in_main = f.name == "main"
        self.function_id = -1 if self.in_main else self.ids
        parameters = ", ".join(f"{self.full(p.type)}{'&' if p.direction != 'in' else ''} u_{p.name}"
                               for p in f.parameters)
        yield f"{self.full(f.result)} u_{f.name}({parameters}) {{"
        if self.stage.concurrent and not self.in_main and _jumps(f.body, "return"):
            yield f"Join function_end{{{self.function_id}}};"
        with self._scope({p.name for p in f.parameters}):
            for statement in f.body.body:
                yield from self._statement(statement)
        yield "}"

    # ---- statements

    def _statement(self, s: Statement) -> Iterator[str]:
        match s:
            case Block(body=body):
                yield "{"
                with self._scope():
                    for one in body:
                        yield from self._statement(one)
                yield "}"
            case Declaration():
                yield f"#line {s.line}"
                for variable in s.variables:
                    value = f" = {self._converted(variable)}" if variable.value else "{}"
                    self.scopes[-1].add(variable.name)
                    yield f"{self.full(variable.type)} u_{variable.name}{value};"
            case Evaluate(expression=expression):
                yield f"#line {s.line}"
                yield f"{self.value(expression)};"
            case If():
                yield from self._if(s)
            case Loop():
                yield from self._loop(s)
            case Jump():
                yield f"#line {s.line}"
                yield self._jump(s)
            case _:
                raise self.unknown(s.line, type(s).__name__)

    def _converted(self, variable: Variable) -> str:
        value = self.value(variable.value)
        scalar = variable.type.name in SCALARS and not variable.type.lengths
        return f"make<{self.type(variable.type.name)}>({value})" if scalar else value

    def _jump(self, s: Jump) -> str:
        if s.word == "discard":
            if not self.in_main:
                raise self.unknown(s.line, "discard outside main")
            return "{ outputs().discarded = true; return; }"
        return f"{s.word} {self.value(s.value)};" if s.value else f"{s.word};"

    def _condition(self, expression: Expression, meeting: int, own: int, returns: bool) -> str:
        """A condition at which lanes may part: `meeting` is where they meet again."""
        value = self.value(expression)
        if not self.stage.concurrent:
            return value
        return f"branch({value}, {meeting if meeting != own else own}, {'true' if returns else 'false'})"

    def _if(self, s: If) -> Iterator[str]:
        self.ids += 1
        own = self.ids
        returns = _jumps(s, "return") or _jumps(s, "discard")
        leaves = _jumps(s, "break", nested=False) or _jumps(s, "continue", nested=False)
        meeting = self.function_id if returns else self.loops[-1] if leaves and self.loops else own
        yield "{"
        if self.stage.concurrent and meeting == own:
            yield f"Join end_of_if{{{own}}};"
        yield f"#line {s.line}"
        yield f"if ({self._condition(s.condition, meeting, own, returns and not self.in_main)})"
        yield from self._braced(s.then)
        if s.otherwise:
            yield "else"
            yield from self._braced(s.otherwise)
        yield "}"

    def _braced(self, s: Statement) -> Iterator[str]:
        yield from self._statement(s if isinstance(s, Block) else Block(s.line, (s,)))

    def _loop(self, s: Loop) -> Iterator[str]:
        self.ids += 1
        own = self.ids
        returns = _jumps(s.body, "return") or _jumps(s.body, "discard")
        meeting = self.function_id if returns else own
        yield "{"
        with self._scope():
            if s.start:
                yield from self._statement(s.start)
            if self.stage.concurrent and meeting == own:
                yield f"Join end_of_loop{{{own}}};"
            self.loops.append(meeting)
            condition = self._condition(s.condition, meeting, own, False) if s.condition else "true"
            yield f"#line {s.line}"
            if s.after:
                yield "do"
                yield from self._braced(s.body)
                yield f"while ({condition});"
            else:
                yield f"for (; {condition}; {self.value(s.step) if s.step else ''})"
                yield from self._braced(s.body)
            self.loops.pop()
        yield "}"


def _jumps(s, word: str, nested: bool = True) -> bool:
    """Whether a statement contains such a jump; unless `nested`, not counting those inside loops in it."""
    match s:
        case Jump():
            return s.word == word
        case Block(body=body):
            return any(_jumps(one, word, nested) for one in body)
        case If():
            return _jumps(s.then, word, nested) or (s.otherwise is not None and _jumps(s.otherwise, word, nested))
        case Loop():
            return nested and _jumps(s.body, word, nested)
    return False

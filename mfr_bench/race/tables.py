"""The generated C++ file of a frame: its shaders, and the tables by which the machine draws it."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from functools import cache

from ..errors import ShaderError
from ..glsl.bindings import DIAGNOSTICS
from ..methods.spec import IMAGE, State
from .adapter import DIAGNOSTICS_BUFFER, Frame, FramePass, base_of, locator, tile_buffers
from .cpp import translate
from .parser import parse
from .values import Sites, Stage

FORMATS = ("r8", "rg8", "rgba8", "r16", "rgba16f", "r32f", "rg32f", "rgba32f", "r32ui", "rg32ui", "depth16",
           "depth32f", "depth24_stencil8")
INTEGERS = ("r32ui", "rg32ui")
EQUATIONS = {"add": 1, "max": 2}
FACTORS = ("zero", "one", "one_minus_src_alpha", "dst_alpha", "one_minus_dst_alpha", "src_alpha")
DEPTH_TESTS = (None, "less", "lequal", "equal", "always")
KINDS = ("geometry", "fullscreen", "compute", "clear")
_LINE = re.compile(r"^\s*#line (\d+)")
_BRANCH = re.compile(r"^\s*#\s*(?:else|elif|endif)\b")
_EXTENSION = re.compile(r"^\s*#\s*(?:extension\s+(?P<name>\w+).*|version\s+(?P<version>\d+).*)$", re.MULTILINE)


def _lines_told_again(text: str) -> str:
    """The text with its line number after each branch: a preprocessor reads no `#line` in a branch that it skips."""
    lines, number = [], 0
    for line in text.splitlines():
        marker = _LINE.match(line)
        number = int(marker[1]) if marker else number + 1
        lines.append(line)
        if _BRANCH.match(line):
            lines.append(f"#line {number + 1}")
        number -= marker is not None
    return "\n".join(lines) + "\n"


@cache
def preprocessed(text: str, compiler: str) -> str:
    """A stage with its macros expanded, by the C++ compiler's own preprocessor; extensions count as present."""
    names = [m["name"] for m in _EXTENSION.finditer(text) if m["name"]]
    plain = _lines_told_again(_EXTENSION.sub("", text))
    defines = [f"-D{name}=1" for name in names]
    done = subprocess.run([compiler, "-E", "-undef", "-w", "-x", "c", *defines, "-"], input=plain, capture_output=True,
                          text=True, check=False)
    if done.returncode:
        raise ShaderError(f"the preprocessor: {done.stderr.strip().splitlines()[0]}")
    return done.stdout


def generate(frame: Frame, compiler: str) -> tuple[str, Sites]:
    """The C++ file of a frame, and the sites that its numbers mean."""
    sites = Sites()
    shaders = [_shader(frame, number, p, compiler, sites) for number, p in enumerate(frame.passes) if p.sources]
    lines = ['#include "machine.hpp"', "using namespace race;", *shaders, "namespace race {", *_resources(frame)]
    for number, p in enumerate(frame.passes):
        lines += _pass_tables(frame, number, p)
    lines += ["static const PassDesc passes[] = {", *(_pass(frame, n, p) for n, p in enumerate(frame.passes)), "};"]
    lines += ["static const StepDesc steps[] = {",
              *(f"{{{s.step}, {s.iteration}, {-1 if s.leave is None else s.leave}}}," for s in frame.steps), "};"]
    return "\n".join([*lines, _frame(frame), "}  // namespace race"]) + "\n", sites


def _shader(frame: Frame, number: int, p: FramePass, compiler: str, sites: Sites) -> str:
    locate = locator(p.own)
    shader = parse(preprocessed(p.own.text, compiler), locate)
    stage = Stage(number, _slots(p), {b.name: b.index for b in p.textures}, _locations(frame, p), p.concurrent)
    return translate(shader, stage, sites, locate)


def _slots(p: FramePass) -> dict[str, int]:
    return {b.name: at for at, b in enumerate(p.buffers)} | dict.fromkeys(DIAGNOSTICS, len(p.buffers))


def _locations(frame: Frame, p: FramePass) -> dict[str, int]:
    """The outputs by their names in the shader. A target of several layers takes as many locations."""
    targets = {t.name: t for t in frame.targets}
    found, location = {}, 0
    for ref in p.outputs:
        name = base_of(ref)[0]
        found[f"out_{name}"] = location
        location += frame.fitted.layer_count(targets[name])
    return found


def _resources(frame: Frame) -> Iterator[str]:
    yield "static const BufferDesc buffers[] = {"
    yield from (f'{{"{b.name}", {frame.words[b.name]}u, {b.copies}}},' for b in frame.buffers)
    yield "};"
    yield "static const TargetDesc targets[] = {"
    for t in frame.targets:
        samples, layers = frame.fitted.samples(t), frame.fitted.layer_count(t)
        yield (f'{{"{t.name}", {FORMATS.index(t.format)}, {t.copies}, {samples}, {layers}, '
               f'{_bool(t.attaches == "depth")}, {_bool(t.format in INTEGERS)}}},')
    yield "};"


def _bool(value: object) -> str:
    return "true" if value else "false"


def _index(names: list[str], what: str | None) -> int:
    return -1 if what is None else names.index(what)


def _buffer_names(frame: Frame) -> list[str]:
    return [b.name for b in frame.buffers]


def _target_names(frame: Frame) -> list[str]:
    return [t.name for t in frame.targets]


def _pass_tables(frame: Frame, number: int, p: FramePass) -> Iterator[str]:
    by_name = {b.name: b for b in frame.buffers}
    yield f"static const BindingDesc bindings{number}[] = {{"
    for b in p.buffers:
        name, role = base_of(b.ref)
        yield f'{{"{b.name}", {_buffer_names(frame).index(name)}, {role}, {_bool(by_name[name].coherent)}}},'
    yield f'{{"diagnostics", {_buffer_names(frame).index(DIAGNOSTICS_BUFFER)}, 0, true}}}};'
    yield f"static const TextureDesc textures{number}[] = {{"
    for b in p.textures:
        name, role = base_of(b.ref)
        yield f"{{{_target_names(frame).index(name)}, {role}}},"
    yield "{0, 0}};"
    yield f"static const OutputDesc outputs{number}[] = {{"
    yield from (_output(frame, p, ref) for ref in dict.fromkeys((*p.outputs, *p.step.into, *p.step.clears)))
    yield "{0, 0, 0, 0, false, {}, false}};"


def _output(frame: Frame, p: FramePass, ref: str) -> str:
    name, role = base_of(ref)
    target = next(t for t in frame.targets if t.name == name)
    layers = frame.fitted.layer_count(target)
    clear = p.step.clears.get(ref)
    values = ", ".join(f"{float(v)}f" for v in (*(clear or ()), 0, 0, 0, 0)[:4])
    location = _locations(frame, p).get(f"out_{name}", 0)
    drawn = layers if ref in p.step.into else 0
    return (f"{{{_target_names(frame).index(name)}, {role}, {drawn}, {location}, {_bool(clear)}, {{{values}}}, "
            f"{_bool(ref in p.step.keeps)}}},")


def _outputs_count(p: FramePass) -> int:
    return len(dict.fromkeys((*p.outputs, *p.step.into, *p.step.clears)))


def _blends(state: State) -> tuple[str, int]:
    def one(blend, alpha=None) -> str:
        equation, source, destination = blend
        factors = (source, destination, *(alpha or (source, destination)))
        return f"{{{EQUATIONS[equation]}, {', '.join(str(FACTORS.index(f)) for f in factors)}}}"

    found = [one(state.blend, state.blend_alpha)] if state.blend else [one(b) for b in state.blends]
    return "{" + ", ".join(found) + "}", len(found)


def _pass(frame: Frame, number: int, p: FramePass) -> str:
    step, state = p.step, p.step.state
    blends, blend_count = _blends(state)
    stencil = state.stencil
    slots = {b.ref: at for at, b in enumerate(p.buffers)}
    written = [slots[ref] for ref in step.writes if ref in slots] if step.kind == "clear" else []
    depths = {t.name for t in frame.targets if t.attaches == "depth"}
    writes_depth = any(base_of(ref)[0] in depths for ref in step.into)
    run = f"pass{number}::run" if p.sources else "nullptr"
    local = (f"pass{number}::local_x, pass{number}::local_y", f"pass{number}::shared_words") if p.sources else ("0, 0",
                                                                                                               "0")
    command = _index(_buffer_names(frame), step.command)
    fields = [
        f'"{step.name}"', str(KINDS.index(step.kind)), run, f"bindings{number}", str(len(p.buffers)),
        f"textures{number}", str(len(p.textures)), f"outputs{number}", str(_outputs_count(p)), blends, str(blend_count),
        str(DEPTH_TESTS.index(state.depth_test)), _bool(state.depth_write and writes_depth), _bool(state.early),
        _bool(writes_depth), _bool(not state.multisample),
        f"{('always', 'equal').index(stencil.test) + 1}" if stencil else "0",
        f"{('increment', 'decrement').index(stencil.update) + 1}" if stencil else "0",
        str(stencil.reference if stencil else 0), _bool(step.region), _bool(step.corner), _bool(step.by_tile),
        _bool(p.concurrent),
        _bool(step.counts), _bool(step.counts and frame.capacity_is_counted),
        *((f"pass{number}::interlocked", f"pass{number}::ordered") if p.sources else ("false", "false")),
        _bool(_uses_mask(p)), _bool(step.fetched), str(p.instances), str(p.groups), local[0], str(command),
        str(step.defines.get("CLASS", -1)), "{" + ", ".join(map(str, written)) + "}", str(len(written)), local[1],
    ]
    return "{" + ", ".join(fields) + "},"


def _uses_mask(p: FramePass) -> bool:
    return bool(p.sources) and "gl_SampleMask[" in p.own.text


def _frame(frame: Frame) -> str:
    names = _buffer_names(frame)
    tile_list, tile_command = tile_buffers(frame)
    left, bottom, columns, rows = frame.region
    fields = [
        "buffers", str(len(names)), "targets", str(len(frame.targets)), "passes", str(len(frame.passes)), "steps",
        str(len(frame.steps)), "0", f"{frame.stats.W}u", f"{frame.stats.H}u", f"{frame.capacity}u",
        f"{frame.chosen_k}u", str(names.index(DIAGNOSTICS_BUFFER)), str(_index(names, frame.grown_counter)),
        str(_target_names(frame).index(IMAGE)), str(_index(names, tile_list)), str(_index(names, tile_command)),
        f"{{{left}u, {bottom}u, {columns}u, {rows}u}}",
    ]
    return f"extern const FrameDesc frame = {{{', '.join(fields)}}};"

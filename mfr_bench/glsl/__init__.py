"""Shader text: includes expanded, a prelude of everything that Python owns, errors mapped back to files.

Python owns the numbers that both sides need (bindings, stats, parameters); the prelude carries them into
GLSL. Only those that the shader names are written, so that programs are shared wherever they are equal.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from ..errors import ShaderError
from ..methods.spec import (
    ELEMENT_WORDS,
    EMPTY,
    FORMAT_WORDS,
    IMAGE,
    Buffer,
    Decided,
    Pass,
    Planned,
    SceneStats,
    Target,
    Variant,
)
from ..resources import shaders_dir
from . import counters as instrument

VERSION = "#version 430 core"
VERSION_FOR_FEATURES = "#version 450 core"  # what the extensions of FEATURE_EXTENSIONS are written against
LINE_STRIDE = 100_000  # line numbers carry the file: Mesa drops the source number of #line
DIAGNOSTICS_BINDING = 7  # GL guarantees eight storage blocks to a fragment shader
DIAGNOSTICS = ("lost_fragments", "arrived_fragments", "held_fragments")  # counters outside every method's memory
LOCK_TRIES = 60000  # below the 65,535 iterations at which llvmpipe ends a loop silently

# The uniform block `Frame`, one uint each, in order.
FRAME_FIELDS = ("width", "height", "pixels", "capacity", "seed", "keep_threshold", "chosen_k")
FRAME_BINDING = 0
COLOURS_BINDING = 1  # of the uniform block `Colours`: the base colours of a payload of two channels, as light
# Behind them, for methods that plan their frames: the rectangle that bounds the geometry, whose first pixel
# would have the index region_first if the rectangle began at the origin.
REGION_FIELDS = ("region_first", "region_columns", "region_pixels")
# Behind these, for compute passes with `region`, which no scissor bounds: its edges in pixels, right and top beyond it.
EDGE_FIELDS = ("region_left", "region_bottom", "region_right", "region_top")

FEATURE_EXTENSIONS: Mapping[str, tuple[str, ...]] = {
    "fragment_shader_interlock": ("GL_ARB_fragment_shader_interlock", "GL_NV_fragment_shader_interlock",
                                  "GL_INTEL_fragment_shader_ordering"),
    "shader_atomic_int64": ("GL_NV_shader_atomic_int64",),
}

_INTEGER = {"r32ui": "u"}  # the letter before GLSL's type for texels that are whole numbers
# Fragment and payload as GLSL types, by the words of the payload. A struct of three words has no padding in std430.
TYPES: Mapping[int, tuple[str, ...]] = {
    1: ("#define FRAGMENT uvec2", "#define PAYLOAD uint"),
    2: ("struct Fragment { uint x; uint y; uint z; };", "#define FRAGMENT Fragment", "#define PAYLOAD uvec2"),
}

_INCLUDE = re.compile(r'^\s*#include\s+(?:"(?P<path>[^"]+)"|<(?P<slot>\w+)>)\s*$')


@dataclass(frozen=True)
class Source:
    """One shader stage: its full text, and the files that its #line numbers refer to."""

    entry: str
    text: str
    files: tuple[str, ...]
    counted: bool = False

    def located(self, log: str) -> str:
        """A driver's log with encoded lines as file:line. Mesa writes `0:300014(3):`, NVIDIA `0(300014) :`."""
        def name(match: re.Match[str]) -> str:
            number, line = divmod(int(match["mesa"] or match["nvidia"]), LINE_STRIDE)
            return f"{self.files[number]}:{self._line(number, line)}" if number < len(self.files) else match[0]
        return re.sub(r"^\d+(?::(?P<mesa>\d+)\(\d+\)|\((?P<nvidia>\d+)\)\s?)", name, log, flags=re.MULTILINE)

    def _line(self, number: int, line: int) -> int:
        """The line of a file for a line of its text here, where those that count may be left out."""
        if number == 0 or self.counted:
            return line
        lines = read(self.files[number]).splitlines()
        kept = [at for at, text in enumerate(lines, start=1) if not instrument.is_counter(text)]
        return kept[line - 1] if 0 < line <= len(kept) else line


@cache
def read(path: str) -> str:
    """Text of a file below shaders/."""
    file = shaders_dir() / path
    try:
        return file.read_text(encoding="utf-8")
    except OSError as error:
        raise ShaderError(f"{path}: cannot be read: {error.strerror}") from None


def _lines(path: str, counted: bool) -> list[str]:
    """The lines of a file, without those that count where nothing is counted."""
    return [line for line in read(path).splitlines() if counted or not instrument.is_counter(line)]


def expand(entry: str, slots: Mapping[str, str], counted: bool = False) -> tuple[str, tuple[str, ...]]:
    """Text of `entry` with every include in place, each file once; `#include <slot>` is the method's choice."""
    files: list[str] = ["prelude"]
    lines: list[str] = []

    def add(path: str) -> None:
        if path in files:
            return
        files.append(path)
        number = len(files) - 1
        lines.append(f"#line {number * LINE_STRIDE + 1}")
        for at, line in enumerate(_lines(path, counted), start=1):
            match = _INCLUDE.match(line)
            if not match:
                lines.append(line)
                continue
            target = match["path"] or slots.get(match["slot"])
            if target is None:
                raise ShaderError(f"{path}:{at}: the method gives no include for <{match['slot']}>")
            try:
                add(target)
            except ShaderError as error:
                raise ShaderError(f"{path}:{at}: {error}") from None
            lines.append(f"#line {number * LINE_STRIDE + at + 1}")

    add(entry)
    return "\n".join(lines) + "\n", tuple(files)


def define_values(variant: Variant, step: Pass, stats: SceneStats) -> dict[str, int]:
    """Every number that a pass of the variant may use, by its name in GLSL."""
    values: dict[str, int] = {
        "EMPTY": EMPTY, "LOCK_TRIES": LOCK_TRIES,
        "N": stats.n, "KEEP": variant.value("keep", stats), "LOCAL": variant.value("keep", stats),
        "REJECTS": int(stats.rejects), "LEAST": stats.least, "QUADS": stats.primitives,
        "COMPUTE": int(step.kind == "compute"),
        "PAYLOAD_RGBA16F": 0, "CULLS": 0, "BY_TILE": int(step.by_tile), "REGION": int(step.region),
        "STOP_OPACITY": 1.0,
        "ACCUMULATE_COMPENSATED": 0, "ACCUMULATE_FLOAT16": 0, "ACCUMULATE_UNORM8": 0,
    }
    for param in variant.all_params:
        value = variant.scope[param.name]
        if param.choices:
            values |= {f"{param.name}_{choice}".upper(): int(choice == value) for choice in param.choices}
        else:
            values[param.name.upper()] = value
    formulas = {name: variant.value(str(value), stats) for name, value in step.defines.items()}
    return values | formulas


def literal(name: str, value: int) -> str:
    return f"{value}u" if name == "EMPTY" else str(value)


def _buffer_block(buffer: Buffer, binding: int, name: str, readonly: bool) -> str:
    qualifiers = ("coherent " if buffer.coherent and not readonly else "") + ("readonly " if readonly else "")
    return f"layout(std430, binding = {binding}) {qualifiers}buffer Block{binding} {{ {buffer.type} {name}[]; }};"


@dataclass(frozen=True)
class Binding:
    """Where a pass finds a resource: `ref` as declared (`name`, `name.current`, `name.previous`)."""

    ref: str
    name: str
    index: int


def split_ref(ref: str) -> tuple[str, str]:
    """`depth.previous` -> ("depth", "previous"); a plain name has no role."""
    name, _, role = ref.partition(".")
    return name, role


def buffer_bindings(variant: Variant, step: Pass) -> list[Binding]:
    """Storage bindings of a pass. A pass that touches both copies of a buffer sees `name_previous` as well."""
    names = {b.name for b in variant.buffers}
    refs = [r for r in dict.fromkeys(step.writes + step.reads) if split_ref(r)[0] in names]
    bindings: list[Binding] = []
    taken: set[str] = set()
    for index, ref in enumerate(refs):
        base, role = split_ref(ref)
        name = base if base not in taken else f"{base}_{role}"
        taken.add(name)
        bindings.append(Binding(ref, name, index))
    if len(bindings) > DIAGNOSTICS_BINDING:
        raise ShaderError(f"{variant.method.id}: pass {step.name!r} uses {len(bindings)} buffers; "
                          f"at most {DIAGNOSTICS_BINDING}")
    return bindings


def texture_bindings(variant: Variant, step: Pass) -> list[Binding]:
    """Texture units of a pass. A pass that reads both copies of a target sees `name` and `name_current`, say."""
    names = {t.name for t in variant.targets} | {IMAGE}
    refs = [split_ref(r) for r in step.reads if split_ref(r)[0] in names]
    first = dict(reversed(refs))
    return [Binding(f"{name}.{role}" if role else name, name if role == first[name] else f"{name}_{role}", index)
            for index, (name, role) in enumerate(refs)]


def _sampler(target: Target | None) -> str:
    """GLSL type by which a target, or the image, is read, texel by texel."""
    if target is None:
        return "sampler2D"
    kind = "2DMS" if target.samples else "2DArray" if target.layers else "2D"
    return f"{_INTEGER.get(target.format, '')}sampler{kind}"


def _clear_macro(variant: Variant, step: Pass) -> str:
    """CLEAR(p): pixel p gives every P-th element of the pass's buffers its initial value."""
    def end(buffer: Buffer) -> str:
        heads = buffer.clear_heads
        return f"pixels * uint({1 if heads is True else heads})" if heads else f"uint({buffer.name}.length())"

    def value(buffer: Buffer) -> str:
        words = 1 + variant.payload_words if buffer.type == "FRAGMENT" else 1
        return f"{buffer.type}({', '.join([buffer.clear or ''] * words)})"

    body = " ".join(f"for (uint i = (p); i < {end(b)}; i += pixels) {b.name}[i] = {value(b)};"
                    for b in variant.buffers if b.name in step.writes)
    return f"#define CLEAR(p) {{ {body} }}"


def _version(variant: Variant, words: set[str]) -> list[str]:
    """The language and the extensions that the variant's features and the shader's words ask for."""
    shading = [feature for feature in variant.needs if feature in FEATURE_EXTENSIONS]
    extensions = [name for feature in shading for name in FEATURE_EXTENSIONS[feature]]
    extensions += ["GL_ARB_gpu_shader_int64"] if "shader_atomic_int64" in variant.needs else []
    extensions += ["GL_ARB_ES3_1_compatibility"] if "IS_HELPER" in words else []
    version = VERSION_FOR_FEATURES if shading else VERSION
    return [version, *(f"#extension {name} : enable" for name in extensions)]


def _diagnostics(words: set[str], counted: bool) -> list[str]:
    """The block of counters, as far as the shader needs it."""
    if not (counted or words.intersection(DIAGNOSTICS)):
        return []
    return [f"layout(std430, binding = {DIAGNOSTICS_BINDING}) buffer Diagnostics {{ "
            + " ".join(f"uint {name};" for name in DIAGNOSTICS) + (" uint work[];" if counted else "") + " };"]


def _storage(variant: Variant) -> dict[str, instrument.Stored]:
    """What the variant's shaders may access, by the names that they have there."""
    found: dict[str, instrument.Stored] = {}
    for buffer in variant.buffers:
        wider = variant.payload_words - 1 if buffer.type in ("FRAGMENT", "PAYLOAD") else 0
        found[buffer.name] = instrument.Stored(ELEMENT_WORDS[buffer.type] + wider, buffer.type != "uint")
    for target in variant.targets:
        found[target.name] = instrument.Stored(math.ceil(FORMAT_WORDS[target.format]))
    found[IMAGE] = instrument.Stored(FORMAT_WORDS["rgba32f"])
    roles = {f"{name}_{role}": stored for name, stored in found.items() for role in ("current", "previous")}
    return found | roles


def source(variant: Variant, step: Pass, stats: SceneStats, entry: str | None = None, counted: bool = False,
           mapped: str | None = None) -> Source:
    """The stage `entry` (default: the pass's own shader) of one pass, ready to compile.

    `counted`: counting its work. `mapped`: counting one kind of it for each pixel, where the shader has a line for it.
    """
    entry = entry or step.shader
    slots = {name: path for name, path in (("fetch", step.fetch), ("resolver", step.resolver)) if path}
    counted = (counted or mapped is not None) and not entry.endswith(".vert")
    body, files = expand(entry, slots, counted)
    macro = _clear_macro(variant, step)
    words = set(re.findall(r"[A-Za-z_]\w*", body))
    words |= set(re.findall(r"[A-Za-z_]\w*", macro)) if "CLEAR" in words else set()
    prelude = _version(variant, words)
    values = define_values(variant, step, stats)
    prelude += [f"#define {name} {literal(name, value)}" for name, value in sorted(values.items()) if name in words]
    prelude += ["#define K chosen_k"] if "K" in words and isinstance(variant.method.capacity, Decided) else []
    prelude += TYPES[variant.payload_words]
    prelude.append(f"layout(std140, binding = {FRAME_BINDING}) uniform Frame {{ "
                   + " ".join(f"uint {name};" for name in _frame_fields(variant, step)) + " };")
    if "base_a" in words:
        prelude.append(f"layout(std140, binding = {COLOURS_BINDING}) uniform Colours {{ vec4 base_a; vec4 base_b; }};")
    if not entry.endswith(".vert"):
        by_name = {b.name: b for b in variant.buffers}
        prelude += [_buffer_block(by_name[split_ref(b.ref)[0]], b.index, b.name, b.ref not in step.writes)
                    for b in buffer_bindings(variant, step)]
        targets = {t.name: t for t in variant.targets}
        prelude += [f"layout(binding = {b.index}) uniform {_sampler(targets.get(split_ref(b.ref)[0]))} {b.name};"
                    for b in texture_bindings(variant, step)]
        prelude += [macro] if "CLEAR" in words else []
        prelude += _outputs(variant, step, stats)
        prelude += ["layout(early_fragment_tests) in;"] if step.state.early else []
        prelude += _diagnostics(words, counted)
    if counted and mapped:
        text = instrument.mapped("\n".join(prelude), body, mapped)
        return Source(entry, text, files, counted) if text else source(variant, step, stats, entry)
    if counted:
        return Source(entry, instrument.counting("\n".join(prelude), body, _storage(variant)), files, counted)
    return Source(entry, "\n".join(prelude) + "\n" + body, files, counted)


def _frame_fields(variant: Variant, step: Pass) -> tuple[str, ...]:
    """What the pass sees of the uniform block `Frame`."""
    if step.kind == "compute" and step.region:
        return FRAME_FIELDS + REGION_FIELDS + EDGE_FIELDS
    return FRAME_FIELDS + (REGION_FIELDS if isinstance(variant.method.capacity, Planned) else ())


def colour_refs(variant: Variant, step: Pass) -> list[str]:
    """The colour targets of a pass in location order; the depth target is attached apart."""
    depth = {t.name for t in variant.targets if t.attaches == "depth"}
    return [ref for ref in step.into if split_ref(ref)[0] not in depth]


def _outputs(variant: Variant, step: Pass, stats: SceneStats) -> list[str]:
    """The colour targets as the shader writes them: outputs at locations, or images at units."""
    targets = {t.name: t for t in variant.targets}
    lines: list[str] = []
    location = 0
    for ref in colour_refs(variant, step):
        name = split_ref(ref)[0]
        target = targets.get(name)
        layers = variant.layer_count(target, stats) if target else 1
        array = f"[{layers}]" if target and target.layers else ""
        kind = _INTEGER.get(target.format, "") if target else ""
        lines.append(f"layout(rgba32f, binding = {location}) writeonly uniform image2D out_{name};"
                     if step.kind == "compute" else f"layout(location = {location}) out {kind}vec4 out_{name}{array};")
        location += layers
    return lines


def _vertex(step: Pass, stats: SceneStats) -> str:
    return step.vertex or (f"scene/{stats.geometry}.vert" if step.kind == "geometry" else "screen/triangle.vert")


def stages(variant: Variant, step: Pass, stats: SceneStats, counted: bool = False,
           mapped: str | None = None) -> tuple[Source, ...]:
    """All stages of a pass: vertex and fragment, or compute alone; `counted` and `mapped` are as for `source`."""
    own = source(variant, step, stats, counted=counted, mapped=mapped)
    if step.kind == "compute":
        return (own,)
    return source(variant, step, stats, _vertex(step, stats)), own

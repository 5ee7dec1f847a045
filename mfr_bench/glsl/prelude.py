"""The prelude of every shader, with all that Python owns: numbers, types, bindings, outputs. And the stages of a pass.

Only what the shader names is written, so that programs are shared wherever they are equal.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from ..methods.spec import (
    ELEMENT_WORDS,
    EMPTY,
    FORMAT_WORDS,
    FRAMEBUFFER_FETCH,
    IMAGE,
    Buffer,
    Decided,
    Fitted,
    Pass,
    SceneStats,
    Target,
    Variant,
)
from . import counters
from .bindings import (
    ALONE_BINDING,
    ALONE_FIELDS,
    BOX_BINDING,
    BOX_FIELDS,
    COLOURS_BINDING,
    DIAGNOSTICS,
    DIAGNOSTICS_BINDING,
    EDGE_FIELDS,
    FRAME_BINDING,
    FRAME_FIELDS,
    OPAQUE_UNIT,
    Binding,
    buffer_bindings,
    colour_refs,
    length_name,
    pair_reader_name,
    reader_name,
    split_ref,
    texel_bindings,
    texture_bindings,
)
from .code import code_of
from .includes import StageSource, expand

VERSION = "#version 430 core"
VERSION_FOR_FEATURES = "#version 450 core"  # what the extensions of FEATURE_EXTENSIONS are written against
LOCK_TRIES = 60000  # below the 65,535 iterations at which llvmpipe ends a loop silently

FEATURE_EXTENSIONS: Mapping[str, tuple[str, ...]] = {
    "fragment_shader_interlock": ("GL_ARB_fragment_shader_interlock", "GL_NV_fragment_shader_interlock",
                                  "GL_INTEL_fragment_shader_ordering"),
    "shader_atomic_int64": ("GL_NV_shader_atomic_int64",),
    FRAMEBUFFER_FETCH: ("GL_EXT_shader_framebuffer_fetch",),
}

WINDOW_DEPTH = "gl_FragCoord.z"
# The float whose bits are those of 1 and of 2^-24, less those of the depth: from 2^-24 to 1, it grows from the eye.
MIRRORED_DEPTH = "uintBitsToFloat(0x3F800000u + 0x33800000u - floatBitsToUint({}))"
# The middle of a pixel may lie outside a triangle that covers some of its samples, and its depth beyond that of any
# corner of the scene. Where depths fall from the eye, the least is 2^-24. 2^-126 keeps a zero from being negative.
SAMPLED_DEPTH = "clamp(gl_FragCoord.z, max(uintBitsToFloat(box_near), 1.17549435e-38), uintBitsToFloat(box_far))"
SAMPLED_BEFORE_MIRRORED = "clamp(gl_FragCoord.z, 5.9604645e-8, 1.0)"
# Files, each with the one that is put behind it where the scene asks for that: see `behind` of `expand`.
PAYLOAD_FILE, SHADING_FILE = "common/payload.glsl", "scene/shading.glsl"
ACCUMULATE_FILE, EFFECT_FILE = "common/accumulate.glsl", "effects/apply.glsl"
COVERAGE_FILE = "scene/coverage.glsl"
FRAGMENT_FILE, ONE_SAMPLE_FILE = "scene/fragment.glsl", "scene/one_sample.glsl"
COLOUR_FILE, SHADE_FILE = "common/colour.glsl", "scene/shade.glsl"
DRAWN_AS = {"masked": "quad"}  # kinds of primitives that the vertex shader of another draws
TYPES_OF_64_BITS = ("uint64_t", "int64_t")
_INTEGER = {"r32ui": "u", "rg32ui": "u"}  # the letter before GLSL's type for texels that are whole numbers
# Fragment and payload as GLSL types, by the words of the payload. A struct of three words has no padding in std430.
TYPES: Mapping[int, tuple[str, ...]] = {
    1: ("#define FRAGMENT uvec2", "#define PAYLOAD uint"),
    2: ("struct Fragment { uint x; uint y; uint z; };", "#define FRAGMENT Fragment", "#define PAYLOAD uvec2"),
}


@dataclass(frozen=True)
class Macro:
    """A macro without arguments."""

    name: str
    text: str

    @property
    def definition(self) -> str:
        """The line that defines it."""
        return f"#define {self.name} {self.text}"


def _depth_macro(stats: SceneStats) -> Macro | None:
    """The macro that a fragment shader reads in the place of its window depth; None: it reads that."""
    if stats.one_sample and stats.forward:
        return None
    if stats.forward:
        return Macro("SAMPLED_DEPTH", SAMPLED_DEPTH)
    depth = WINDOW_DEPTH if stats.one_sample else SAMPLED_BEFORE_MIRRORED
    return Macro("MIRRORED_DEPTH", MIRRORED_DEPTH.format(depth))


def _behind(fitted: Fitted, step: Pass) -> dict[str, str]:
    """Files, each with the one that stands behind it in the fragment shader of a pass over the geometry."""
    found = {PAYLOAD_FILE: SHADING_FILE} if fitted.stats.shading else {}
    if not fitted.stats.one_sample:
        found[found.get(PAYLOAD_FILE, PAYLOAD_FILE)] = COVERAGE_FILE
        found |= {COLOUR_FILE: SHADE_FILE} if step.into else {FRAGMENT_FILE: ONE_SAMPLE_FILE}
    return found


def define_values(fitted: Fitted, step: Pass) -> dict[str, int]:
    """Every number that a pass of the variant may use, by its name in GLSL."""
    variant, stats = fitted.variant, fitted.stats
    values: dict[str, int] = {
        "EMPTY": EMPTY, "LOCK_TRIES": LOCK_TRIES,
        "N": stats.n, "SHADING": stats.shading, "KEEP": fitted.value("keep"), "LOCAL": fitted.value("keep"),
        "REJECTS": int(stats.rejects), "OCCLUDED": int(stats.occluded), "LEAST": stats.least, "QUADS": stats.primitives,
        "COMPUTE": int(step.kind == "compute"),
        "PAYLOAD_RGBA16F": 0, "STORES_ALL": 0, "SUMS_FRAGMENT": 0,
        "PAIRS": int(any(fitted.reads_pairs(step, buffer) for buffer in step.pairs)),
        "CULLS": 0, "BY_TILE": int(step.by_tile), "REGION": int(step.region),
        "STOP_OPACITY": 1.0,
        "ACCUMULATE_COMPENSATED": 0, "ACCUMULATE_FLOAT16": 0, "ACCUMULATE_UNORM8": 0,
    }
    for param in variant.all_params:
        value = variant.scope[param.name]
        if param.choices:
            values |= {f"{param.name}_{choice}".upper(): int(choice == value) for choice in param.choices}
        else:
            values[param.name.upper()] = value
    values |= stats.effect.defines
    formulas = {name: fitted.value(str(value)) for name, value in step.defines.items()}
    return values | formulas


def literal(name: str, value: int) -> str:
    """The value of a name as GLSL has it: EMPTY is unsigned."""
    return f"{value}u" if name == "EMPTY" else str(value)


def _buffer_block(buffer: Buffer, bound: Binding, readonly: bool) -> str:
    binding, name = bound.index, bound.name
    if bound.atomic:
        return f"layout(binding = {binding}, offset = 0) uniform atomic_uint {name};"
    qualifiers = ("coherent " if buffer.coherent and not readonly else "") + ("readonly " if readonly else "")
    block = f"layout(std430, binding = {binding}) {qualifiers}buffer Block{binding} {{ {buffer.type} {name}[]; }};"
    return _said(block, buffer)


def _readers(fitted: Fitted, step: Pass, words: frozenset[str], texels: bool) -> list[str]:
    """NAME_at(i) for each buffer that the shader reads so: through a texture of the same memory, or as it lies.

    An element of 64 bits is read as (low word, high word). Where the pass reads pairs, NAME_pair_at(i) reads two
    elements at once, and through a texture NAME_at(i) is a half of that: zink takes a texture of the same memory in
    another format for the one before (docs/drivers.md), so that no frame may have both.
    """
    variant = fitted.variant
    units = {b.ref: b for b in texel_bindings(variant, step)} if texels else {}
    declared = {b.name: b for b in variant.buffers}
    lines: list[str] = []
    for b in buffer_bindings(variant, step):
        pairs = fitted.reads_pairs(step, b.ref)
        if pairs:
            lines += _pair_reader(b.name, units.get(b.ref))
        if reader_name(b.name) not in words:
            continue
        if pairs and b.ref in units:
            lines += _half_reader(declared[b.ref])
        elif b.ref in units:
            lines += _texel_reader(fitted, declared[b.ref], units[b.ref])
        else:
            wide = declared[split_ref(b.ref)[0]].type in TYPES_OF_64_BITS
            element = f"unpackUint2x32(uint64_t({b.name}[at]))" if wide else f"{b.name}[at]"
            lines.append(f"#define {reader_name(b.name)}(at) {element}")
    return lines


def _texel_reader(fitted: Fitted, buffer: Buffer, sampler: Binding) -> list[str]:
    parts = ", ".join(f"texel.{part}" for part in "xyz"[:fitted.element_bytes(buffer) // 4])
    read = "uvec2" if buffer.type in TYPES_OF_64_BITS else buffer.type
    body = f"{{ uvec4 texel = texelFetch({sampler.name}, int(at)); return {read}({parts}); }}"
    return [f"layout(binding = {sampler.index}) uniform usamplerBuffer {sampler.name};",
            f"{read} {reader_name(buffer.name)}(uint at) {body}"]


def _pair_reader(buffer: str, sampler: Binding | None) -> list[str]:
    """NAME_pair_at(i), which reads two elements of two words each: as one texel, or one after the other."""
    name = pair_reader_name(buffer)
    if sampler is None:
        return [f"#define {name}(at) uvec4({buffer}[2u * (at)], {buffer}[2u * (at) + 1u])"]
    return [f"layout(binding = {sampler.index}) uniform usamplerBuffer {sampler.name};",
            f"uvec4 {name}(uint at) {{ return texelFetch({sampler.name}, int(at)); }}"]


def _half_reader(buffer: Buffer) -> list[str]:
    """NAME_at(i), where a texel has two elements."""
    read, name = buffer.type, reader_name(buffer.name)
    pair = f"uvec4 pair = {pair_reader_name(buffer.name)}(at >> 1)"
    return [f"{read} {name}(uint at) {{ {pair}; return (at & 1u) == 0u ? pair.xy : pair.zw; }}"]


def _said(declaration: str, resource: Buffer | Target | None) -> str:
    """The declaration with what the resource contains as a comment behind it."""
    return f"{declaration}  // {resource.doc}" if resource and resource.doc else declaration


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
        return f"pixels * uint({1 if heads is True else heads})" if heads else length_name(buffer.name)

    def value(buffer: Buffer) -> str:
        words = 1 + variant.payload_words if buffer.type == "FRAGMENT" else 1
        return f"{buffer.type}({', '.join([buffer.clear or ''] * words)})"

    body = " ".join(f"for (uint i = (p); i < {end(b)}; i += pixels) {b.name}[i] = {value(b)};"
                    for b in variant.buffers if b.name in step.writes)
    return f"#define CLEAR(p) {{ {body} }}"


def _version(variant: Variant, words: frozenset[str], fetched: Sequence[str]) -> list[str]:
    """The language and the extensions that the variant's features and the shader's words and targets ask for."""
    shading = [feature for feature in variant.needs if feature in FEATURE_EXTENSIONS]
    extensions = [name for feature in shading for name in FEATURE_EXTENSIONS[feature]]
    extensions += ["GL_ARB_gpu_shader_int64"] if "shader_atomic_int64" in variant.needs else []
    extensions += ["GL_ARB_ES3_1_compatibility"] if "IS_HELPER" in words else []
    extensions += FEATURE_EXTENSIONS[FRAMEBUFFER_FETCH] if fetched else ()
    version = VERSION_FOR_FEATURES if shading else VERSION
    return [version, *(f"#extension {name} : enable" for name in extensions)]


def _diagnostics(words: frozenset[str], counted: bool) -> list[str]:
    """The block of counters, as far as the shader needs it."""
    if not (counted or words.intersection(DIAGNOSTICS)):
        return []
    return [f"layout(std430, binding = {DIAGNOSTICS_BINDING}) buffer Diagnostics {{ "
            + " ".join(f"uint {name};" for name in DIAGNOSTICS) + (" uint work[];" if counted else "") + " };"]


def _storage(variant: Variant) -> dict[str, counters.Stored]:
    """The resources that the variant's shaders may access, by the names that they have there."""
    found: dict[str, counters.Stored] = {}
    for buffer in variant.buffers:
        wider = variant.payload_words - 1 if buffer.type in ("FRAGMENT", "PAYLOAD") else 0
        found[buffer.name] = counters.Stored(ELEMENT_WORDS[buffer.type] + wider, buffer.type != "uint")
    for target in variant.targets:
        found[target.name] = counters.Stored(math.ceil(FORMAT_WORDS[target.format]))
    found[IMAGE] = counters.Stored(FORMAT_WORDS["rgba32f"])
    roles = {f"{name}_{role}": stored for name, stored in found.items() for role in ("current", "previous")}
    return found | roles


def _bound(fitted: Fitted, step: Pass) -> str:
    """The bound of loops over the k slots of a pixel: as a uniform, which the host may decide, or as a constant.

    Where nothing else is chosen, what was measured on llvmpipe decides (docs/fairness.md): loops that end early under a
    lock are the faster for a uniform, others for being unrolled. A pass with a K of its own has it as a constant.
    """
    variant = fitted.variant
    chosen = variant.scope.get("bound", "auto")
    if chosen == "auto":
        chosen = "uniform" if "sync" in variant.scope else "constant"
    decided = isinstance(variant.method.capacity, Decided)
    if "K" in step.defines or not (decided or chosen == "uniform"):
        return f"{define_values(fitted, step)['K']}u"
    return "chosen_k"


def source(fitted: Fitted, step: Pass, entry: str | None = None, counted: bool = False,
           mapped: str | None = None, texels: bool = True) -> StageSource:
    """The stage `entry` (default: the pass's own shader) of one pass, ready to compile.

    `texels`: reading buffers through textures, where the pass may. `counted`: counting its work, and reading buffers as
    they lie. `mapped`: counting one kind of work for each pixel, where the shader has a line for it.
    """
    entry = entry or step.shader
    is_vertex = entry.endswith(".vert")
    counted = (counted or mapped is not None) and not is_vertex
    depth = _depth_macro(fitted.stats) if step.kind == "geometry" and not is_vertex else None
    body, files = _expanded(fitted, step, entry, counted)
    body = body.replace(WINDOW_DEPTH, depth.name) if depth else body
    clearing = _clear_macro(fitted.variant, step)
    words = _words_used(body, clearing, depth)
    macros = _macros(fitted, step, words, depth)
    lines = [*_version(fitted.variant, words, () if is_vertex else step.fetched),
             *macros, *_uniform_blocks(step, words.union(*map(_words, macros)))]
    if not is_vertex:
        lines += _resources(fitted, step, words)
        lines += _readers(fitted, step, words, texels and not counted)
        lines += [clearing] if "CLEAR" in words else []
        lines += _outputs(fitted, step)
        lines += ["layout(early_fragment_tests) in;"] if step.state.early else []
        lines += _diagnostics(words, counted)
    prelude = "\n".join(lines)
    if counted and mapped:
        text = counters.mapped(prelude, body, mapped)
        return StageSource(entry, text, files, counted) if text else source(fitted, step, entry, texels=texels)
    text = counters.counting(prelude, body, _storage(fitted.variant)) if counted else f"{prelude}\n{body}"
    return StageSource(entry, text, files, counted)


def _expanded(fitted: Fitted, step: Pass, entry: str, counted: bool) -> tuple[str, tuple[str, ...]]:
    """The stage with its includes, slots and the files that stand behind others, and the files that it is made of."""
    slots = {name: path for name, path in (("fetch", step.fetch), ("resolver", step.resolver)) if path}
    is_vertex = entry.endswith(".vert")
    behind = _behind(fitted, step) if step.kind == "geometry" and not is_vertex else {}
    if not fitted.stats.blended and step.hands_on and not is_vertex:
        slots["effect"] = f"effects/{fitted.stats.effect.module}.glsl"
        behind[ACCUMULATE_FILE] = EFFECT_FILE
    return expand(entry, slots, counted, behind)


@lru_cache(maxsize=512)
def _words(text: str) -> frozenset[str]:
    """The names and words in the code of a text, which many variants share."""
    return frozenset(re.findall(r"[A-Za-z_]\w*", code_of(text)))


def _words_used(body: str, clearing: str, depth: Macro | None) -> frozenset[str]:
    """The names and words of a shader, and of the macros that it uses."""
    words = _words(body)
    used = [clearing] if "CLEAR" in words else []
    used += [depth.text] if depth and depth.name in words else []
    return words.union(*map(_words, used))


def _macros(fitted: Fitted, step: Pass, words: frozenset[str], depth: Macro | None) -> list[str]:
    """The numbers, types and the depth that the shader names."""
    values = define_values(fitted, step)
    lines = [f"#define {name} {literal(name, value)}" for name, value in sorted(values.items()) if name in words]
    lines += [f"#define BOUND {_bound(fitted, step)}"] if "BOUND" in words else []
    decided = isinstance(fitted.variant.method.capacity, Decided)
    lines += ["#define K chosen_k"] if "K" in words and decided else []
    return [*lines, *TYPES[fitted.variant.payload_words], *([depth.definition] if depth else [])]


def _uniform_blocks(step: Pass, words: frozenset[str]) -> list[str]:
    """The block `Frame`, and those of the others that the shader reads."""
    edges = EDGE_FIELDS if step.kind == "compute" and step.region else ()
    blocks = [_uniform_block(FRAME_BINDING, "Frame", FRAME_FIELDS + edges)]
    blocks += [_uniform_block(binding, f"Alone_{field}", (field,))
               for binding, field in enumerate(ALONE_FIELDS, ALONE_BINDING) if field in words]
    blocks += [_uniform_block(BOX_BINDING, "Box", BOX_FIELDS)] if words.intersection(BOX_FIELDS) else []
    if "base_a" in words:
        blocks.append(f"layout(std140, binding = {COLOURS_BINDING}) uniform Colours {{ vec4 base_a; vec4 base_b; }};")
    return blocks


def _uniform_block(binding: int, name: str, fields: Sequence[str]) -> str:
    return f"layout(std140, binding = {binding}) uniform {name} {{ {' '.join(f'uint {field};' for field in fields)} }};"


def _resources(fitted: Fitted, step: Pass, words: frozenset[str]) -> list[str]:
    """The buffers and textures of the pass, and the lengths of the buffers that the shader asks for."""
    variant, bound = fitted.variant, buffer_bindings(fitted.variant, step)
    buffers, targets = ({made.name: made for made in kind} for kind in (variant.buffers, variant.targets))
    lines = [_buffer_block(buffers[split_ref(b.ref)[0]], b, b.ref not in step.writes) for b in bound]
    for b in texture_bindings(variant, step):
        target = targets.get(split_ref(b.ref)[0])
        lines.append(_said(f"layout(binding = {b.index}) uniform {_sampler(target)} {b.name};", target))
    if fitted.stats.occluded and "opaque_depth" in words:
        lines.append(f"layout(binding = {OPAQUE_UNIT}) uniform sampler2D opaque_depth;")
    return lines + [f"uniform uint {length_name(b.name)};" for b in bound if length_name(b.name) in words]


def _outputs(fitted: Fitted, step: Pass) -> list[str]:
    """The colour targets as the shader writes them: outputs at locations, or images at units."""
    variant = fitted.variant
    targets = {t.name: t for t in variant.targets}
    lines: list[str] = []
    location = 0
    for ref in colour_refs(variant, step):
        name = split_ref(ref)[0]
        target = targets.get(name)
        layers = fitted.layer_count(target) if target else 1
        array = f"[{layers}]" if target and target.layers else ""
        kind = _INTEGER.get(target.format, "") if target else ""
        qualifier = "inout" if ref in step.fetched else "out"
        output = (f"layout(rgba32f, binding = {location}) writeonly uniform image2D out_{name};"
                  if step.kind == "compute"
                  else f"layout(location = {location}) {qualifier} {kind}vec4 out_{name}{array};")
        lines.append(_said(output, target))
        location += layers
    return lines


def _vertex(step: Pass, geometry: str) -> str:
    if step.vertex:
        return step.vertex
    return f"scene/{DRAWN_AS.get(geometry, geometry)}.vert" if step.kind == "geometry" else "screen/triangle.vert"


def stages(fitted: Fitted, step: Pass, counted: bool = False, mapped: str | None = None,
           texels: bool = True) -> tuple[StageSource, ...]:
    """All stages of a pass: vertex and fragment, or compute alone; the other parameters are as for `source`."""
    own = source(fitted, step, counted=counted, mapped=mapped, texels=texels)
    if step.kind == "compute":
        return (own,)
    return source(fitted, step, _vertex(step, fitted.stats.geometry)), own

"""Binding points of shaders: storage blocks, texture units, uniform blocks, the counters of diagnostics."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from ..errors import ShaderError
from ..methods.spec import IMAGE, Pass, Variant

DIAGNOSTICS_BINDING = 7  # GL guarantees eight storage blocks to a fragment shader
DIAGNOSTICS = ("lost_fragments", "shaded_fragments", "stored_fragments")  # counters outside every method's memory

# The uniform block `Frame`, one uint each, in order, and what follows in it for compute passes with `region`, which no
# scissor bounds: its edges in pixels, right and top exclusive.
FRAME_FIELDS = ("width", "height")
EDGE_FIELDS = ("region_left", "region_bottom", "region_right", "region_top")
FRAME_BINDING = 0
# What shaders read for each fragment, a uint each in a block of its own: llvmpipe 22.3 reads the first word of a block
# once for a vector of pixels, and any other word pixel by pixel. The last three tell the rectangle that bounds the
# geometry, whose first pixel would have the index region_first if the rectangle began at the origin.
ALONE_FIELDS = ("pixels", "capacity", "seed", "keep_threshold", "chosen_k", "region_first", "region_columns",
                "region_pixels")
ALONE_BINDING = 3  # of the first of these blocks; the others follow
ALONE_BYTES = 256  # from one of them to the next in their buffer, an alignment that every device takes
TEXELS_UNIT = 14  # of the first buffer that a pass reads through a texture; others have the units below
OPAQUE_UNIT = 15  # of the scene's opaque depth: GL guarantees sixteen texture units to a fragment shader
COLOURS_BINDING = 1  # of the uniform block `Colours`: the base colours of a payload of two channels, as light
COLOURS_BYTES = 32  # two vec4
# The uniform block `Box`, declared by shaders that name its fields: the depths of a box around the scene, as the bits
# of floats. A block of its own leaves the text of all other shaders, and with it the keys of their cells, as they are.
BOX_FIELDS = ("box_near", "box_far")
BOX_BINDING = 2


@dataclass(frozen=True)
class Binding:
    """The binding of a resource in a pass: `ref` as declared (`name`, `name.current`, `name.previous`).

    atomic: a dedicated atomic counter, whose `index` is that of its own binding points.
    """

    ref: str
    name: str
    index: int
    atomic: bool = False


@cache
def split_ref(ref: str) -> tuple[str, str]:
    """`depth.previous` -> ("depth", "previous"); a plain name has no role."""
    name, _, role = ref.partition(".")
    return name, role


def buffer_bindings(variant: Variant, step: Pass) -> list[Binding]:
    """The storage bindings of a pass, and those of its atomic counters.

    A pass that touches both copies of a buffer sees `name_previous` as well.
    """
    names = {b.name for b in variant.buffers}
    refs = [r for r in dict.fromkeys(step.writes + step.reads) if split_ref(r)[0] in names and r not in step.atomics]
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
    return bindings + [Binding(ref, ref, index, atomic=True) for index, ref in enumerate(step.atomics)]


def texture_bindings(variant: Variant, step: Pass) -> list[Binding]:
    """The texture units of a pass. A pass that reads both copies of a target sees `name` and `name_current`, say."""
    names = {t.name for t in variant.targets} | {IMAGE}
    refs = [split_ref(r) for r in step.reads if split_ref(r)[0] in names]
    first = dict(reversed(refs))
    return [Binding(f"{name}.{role}" if role else name, name if role == first[name] else f"{name}_{role}", index)
            for index, (name, role) in enumerate(refs)]


def colour_refs(variant: Variant, step: Pass) -> list[str]:
    """The colour targets of a pass in location order; the depth target is attached apart."""
    depth = {t.name for t in variant.targets if t.attaches == "depth"}
    return [ref for ref in step.into if split_ref(ref)[0] not in depth]


def texel_bindings(variant: Variant, step: Pass) -> list[Binding]:
    """The texture units of the buffers that a pass reads through textures of their memory."""
    names = {b.name for b in variant.buffers}
    return [Binding(ref, texels_name(ref), TEXELS_UNIT - index)
            for index, ref in enumerate(ref for ref in step.texels if ref in names)]


def texels_name(buffer: str) -> str:
    """The sampler through which a shader reads a buffer."""
    return f"{buffer}_texels"


def reader_name(buffer: str) -> str:
    """The function, or macro, by which a shader reads an element of a buffer, be it through a texture or not."""
    return f"{buffer}_at"


def pair_reader_name(buffer: str) -> str:
    """The function, or macro, by which a shader reads two adjacent elements of a buffer at once."""
    return f"{buffer}_pair_at"


def length_name(buffer: str) -> str:
    """The uniform with the number of elements of a buffer.

    Mesa 26 gets `.length()` of a storage block wrong in some lanes behind a divergent loop; docs/drivers.md.
    """
    return f"{buffer}_length"

"""Checks what a declaration says, and what its shaders look like; no GL."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import cache
from typing import get_args

from ..config import Scene
from ..glsl import read, stages
from ..methods.spec import Fitted, Guarantee, Method, Variant
from ..plan import expected_stats
from .preprocess import active
from .variants import label, with_k

SIZES = expected_stats(Scene(size=(64, 48), depth_complexity=12, pixel_density=0.5))
ID = r"[a-z][a-z0-9]*(-[a-z0-9]+)*"
MOST_LINES = 150  # of a shader
ENTRY_SUFFIXES = (".vert", ".frag", ".comp")
SHARED = {"occupancy", "bma", "touched"}  # options whose words the page of all methods states once
ATOMIC = re.compile(r"\batomic[A-Z]\w*\(\s*(\w+)\s*\[")


def what_a_reader_needs(method: Method) -> Iterator[str]:
    """Check that the id is a plain name, and that nothing which a table prints is missing."""
    if not re.fullmatch(ID, method.id):
        yield f"the id {method.id!r} is no name of small letters, digits and single hyphens"
    for name in ("name", "family", "source", "summary", "ties"):
        if not getattr(method, name):
            yield f"{name} is empty"
    if method.guarantee not in get_args(Guarantee):
        yield f"the guarantee {method.guarantee!r} is none"
    if (method.failure is not None) != (method.guarantee == "approximate"):
        yield "failure belongs to the guarantee approximate, and to no other"
    if method.exact_where and method.guarantee != "approximate":
        yield "exact_where belongs to the guarantee approximate alone"
    yield from (f"parameter {p.name} has no doc" for p in method.params if not p.doc)


def stages_of(variant: Variant):
    """Each pass that runs shaders, and its stages."""
    for step in (s for s in variant.passes if s.kind != "clear"):
        yield step, stages(Fitted(variant, SIZES), step)


def stages_expand(variants: Iterable[Variant]) -> Iterator[str]:
    """Check that every stage of every pass expands, and that its file is there."""
    for variant in variants:
        for step, found in stages_of(variant):
            for stage in found:
                if "#include" in stage.text:
                    yield f"{label(variant)}, pass {step.name}: {stage.entry} keeps an #include"
                read(stage.entry)  # raises ShaderError where it is not there


def resources_declared(method: Method) -> Iterator[str]:
    """Check that passes name only buffers and targets that are declared."""
    brought = [resource for step in method.passes for resource in (*step.buffers, *step.targets)]
    names = {resource.name for resource in (*method.buffers, *method.targets, *brought)} | {"image"}
    for step in method.passes:
        used = {ref.partition(".")[0] for ref in (*step.reads, *step.writes, *step.into, *step.clears)}
        yield from (f"pass {step.name} uses {name!r}, which is not declared" for name in sorted(used - names))


def resources_explained(variants: Iterable[Variant]) -> Iterator[str]:
    """Check that every buffer and target says on one line what it contains."""
    said = {resource.name: resource.doc for v in variants for resource in (*v.buffers, *v.targets)}
    yield from (f"{name} has no doc of one line" for name, doc in said.items() if not doc or "\n" in doc)


def shaders_show_contents(method: Method) -> Iterator[str]:
    """Check that the GLSL of a pass says behind each block what is in it."""
    variant = method.variant({})
    docs = {b.name: b.doc for b in variant.buffers}
    for step, found in stages_of(variant):
        for name in sorted({ref.partition(".")[0] for ref in (*step.reads, *step.writes)} & set(docs)):
            said = rf"buffer Block\d+ .* {name}(_\w+)?\[\]; }};  // {re.escape(docs[name])}$"
            if not re.search(said, found[-1].text, re.MULTILINE):
                yield f"pass {step.name}: the block of {name} does not say what it contains"


def atomics_declared(variants: Iterable[Variant]) -> Iterator[str]:
    """Check that atomics touch only what the pass declares to write.

    Mesa lets an atomic through on a readonly buffer, and a barrier would then be missing.
    """
    atomics = cache(lambda text: frozenset(ATOMIC.findall(active(text))))  # variants share most of their stages
    for variant in variants:
        for step, found in stages_of(variant):
            touched = {name for stage in found for name in atomics(stage.text)}
            written = {ref.partition(".")[0] for ref in step.writes}
            yield from (f"{label(variant)}, pass {step.name}: an atomic on {name}, which the pass does not write"
                        for name in sorted(touched - written))


def memory_has_values(variants: Iterable[Variant]) -> Iterator[str]:
    """Check that the formulas of memory give sizes."""
    for variant in variants:
        fitted = Fitted(variant, SIZES)
        yield from (f"{label(variant)}: {name} has {size} bytes" for name, size in fitted.memory_bytes().items()
                    if size <= 0)
        if fitted.model_bytes() < 0:
            yield f"{label(variant)}: the paper's words come to {fitted.model_bytes()} bytes"


def words_explained(method: Method, variants: Iterable[Variant]) -> Iterator[str]:
    """Check that `beside` explains what is allocated beyond the paper's words.

    Whatever k is, and for every option but those whose words the page of all methods states once.
    """
    shares = [p for p in method.params if p.name in SHARED]
    plain = [v for v in variants if all(v.params[p.name] == p.default for p in shares)]
    differs = [label(v) for v in plain for k in (7, 8)
               if sum(Fitted(with_k(v, k), SIZES).memory_bytes().values()) != Fitted(with_k(v, k), SIZES).model_bytes()]
    if differs and not method.beside:
        yield f"{differs[0]} allocates other than its words say; `beside` has to say why"


def shader_is_short(path: str) -> Iterator[str]:
    """Check that a file opens with its contract, stays short, and has a main only if it is an entry point."""
    text = read(path)
    lines = text.splitlines()
    if not lines[:1] or not lines[0].startswith("// "):
        yield f"{path}:1: opens with no comment that states its contract"
    if len(lines) > MOST_LINES:
        yield f"{path}: has {len(lines)} lines, allowed: {MOST_LINES}"
    mains = len(re.findall(r"^void main\(\)", text, re.MULTILINE))
    if mains != path.endswith(ENTRY_SUFFIXES):
        yield f"{path}: has {mains} main functions; allowed: one in {', '.join(ENTRY_SUFFIXES)}, none in an include"

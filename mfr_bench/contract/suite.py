"""The checks of the contract, each with its name and what it found: all those of a method."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

from ..errors import MfrError
from ..methods.spec import Method, Variant
from . import declaration, guards, images
from .cases import runs_here
from .variants import variants

Lines = Callable[[], Iterable[str]]
Check = tuple[str, Lines]  # its name, and what gives a line for each fault


@dataclass(frozen=True)
class Outcome:
    """The findings of a check: nothing, or a line for each fault."""

    name: str
    faults: tuple[str, ...]


def missing_features(device, method: Method) -> list[str]:
    """The features that the device lacks for the method at its defaults."""
    return [device.limits.lacks(f) for f in method.variant({}).needs if f not in device.features]


def skipped_variants(device, method: Method) -> int:
    """Variants that the device has no features for."""
    return sum(not runs_here(device, variant) for variant in variants(method))


def of_method(device, method: Method) -> Sequence[Check]:
    """Every check of a method, in order."""
    return *_of_declaration(method), *_of_images(device, method)


def run(checks: Iterable[Check]) -> Iterator[Outcome]:
    """The outcome of each check; the first error of one that cannot be carried out is its fault."""
    for name, lines in checks:
        try:
            yield Outcome(name, tuple(lines()))
        except (MfrError, MemoryError) as error:
            yield Outcome(name, (str(error),))


def _of_declaration(method: Method) -> Sequence[Check]:
    found = variants(method)
    return (
        ("the declaration says what a reader needs", lambda: declaration.what_a_reader_needs(method)),
        ("every stage of every variant expands", lambda: declaration.stages_expand(found)),
        ("passes name only declared resources", lambda: declaration.resources_declared(method)),
        ("every buffer and target says what it contains", lambda: declaration.resources_explained(found)),
        ("shaders show what their buffers contain", lambda: declaration.shaders_show_contents(method)),
        ("atomics touch only what a pass writes", lambda: declaration.atomics_declared(found)),
        ("memory formulas have values", lambda: declaration.memory_has_values(found)),
        ("memory beside the paper's words is explained", lambda: declaration.words_explained(method, found)),
        ("shaders are short and open with their contract", lambda: _short_shaders(found)),
    )


def _short_shaders(found: Iterable[Variant]) -> Iterator[str]:
    """The files that only a method brings: those of its passes, with what they include."""
    files = {path for v in found for _, made in declaration.stages_of(v) for s in made for path in s.files[1:]}
    for path in sorted(files):
        yield from declaration.shader_is_short(path)


def _of_images(device, method: Method) -> Sequence[Check]:
    found = variants(method)
    return (
        ("every image is as promised: layouts, orders, odd sizes", lambda: images.every_scene(device, method)),
        ("slanted primitives that cross", lambda: images.slanted(device, found)),
        ("every option", lambda: (fault for v in found[1:] for fault in images.option(device, v))),
        ("128 layers", lambda: images.deep(device, method)),
        ("every k", lambda: images.all_ks(device, method)),
        ("exact where it says so", lambda: images.exact_where_it_says(device, method, found)),
        ("fifty frames give one image", lambda: images.frames_are_alike(images.fifty_frames(device, method), method)),
        ("what is stored is counted", lambda: images.counts_what_it_holds(device, method)),
        ("nothing is written outside a buffer", lambda: guards.keeps_to_its_buffers(device, method)),
    )

"""The catalog as Markdown: docs/methods.md, which a test compares with the declarations."""

from __future__ import annotations

from collections.abc import Iterable

from ..markdown import markdown_table
from .shared.resolving import REGISTERS_UP_TO
from .spec import ALPHA_STEPS, LEAF_ROUNDINGS, Buffer, Method, Param, Target

HEAD = f"""# The methods

Every method that mfr-bench runs, taken from its declaration (`mfr-bench methods --markdown` prints this page). Words
are 32-bit words per pixel by the paper's formula; n is the most fragments of any pixel, f the fragments of a pixel, f_k
at most k of them, F all fragments of the frame, P the pixels. In addition to the words, occupancy takes 3 words per
pixel and one for every 32 intervals, backwards memory allocation one, a payload of two words one more per fragment;
`touched: tiles` takes one per tile of 16x16 pixels and 8 per frame.

`mfr-bench methods` says whether a device runs a method. By default loops over the k slots of a pixel are bounded by a
uniform under a lock and by a constant elsewhere (`bound: auto`), and a resolve sorts up to
{REGISTERS_UP_TO} fragments by blocks in registers, more by shell sort (`sort: auto`): this was the fastest on llvmpipe,
and no GPU was measured.
docs/fairness.md says how methods differ from their sources, what that is worth, and how they compare with independent
implementations.
"""
CONTENTS = """The formula of a buffer counts 32-bit words; in it `capacity` is the number of fragments that there is
room for. A target has the size of the viewport."""


def _needs(method: Method) -> str:
    """Features of the method, and of single choices of its parameters."""
    chosen = [f"{f} ({p.name}: {choice}{_where(p)})" for p in method.params for choice, f in p.needs.items()]
    return ", ".join([*method.needs, *chosen]) or "nothing more than OpenGL 4.3"


def _where(param: Param) -> str:
    """The condition under which a parameter's values need features."""
    where = param.needs_where
    return f", with {where.name}: {' | '.join(map(str, where.values))}" if where else ""


def _promise(method: Method) -> str:
    parts = [method.guarantee, *([method.failure] if method.failure else []),
             *([f"exact where `{method.exact_where}`"] if method.exact_where else [])]
    return ": ".join(parts[:2]) + "".join(f"; {part}" for part in parts[2:])


def _bound(method: Method) -> str:
    """Error of an exact method by rounding, in words; docs/accuracy.md derives it."""
    if not method.guarantee.startswith("exact"):
        return "none promised"
    names = "n" if method.guarantee == "exact all" else "n, k"
    layers = names if names == "n" else f"min({names})"
    steps = f"5·{layers}" if method.merges else f"{layers}/2 + 2·min({names}, {ALPHA_STEPS})"
    return f"{steps} + {LEAF_ROUNDINGS}" + (f", and `{method.leaves_out}`" if method.leaves_out else "")


def _size(resource: Buffer | Target) -> str:
    """The formula of a buffer's words, or the format of a target with its samples and layers."""
    if isinstance(resource, Buffer):
        size = f"{resource.type}, `{resource.words}` words"
    else:
        more = [f"`{value}` {what}" for what in ("samples", "layers") if (value := getattr(resource, what))]
        size = ", ".join([resource.format, *more])
    return f"{size}, {resource.copies} copies" if resource.copies > 1 else size


def _added(method: Method) -> dict[str, Buffer | Target]:
    """The resources that single choices of parameters add to the method's declared ones, by name."""
    declared = {r.name for r in (*method.buffers, *method.targets)}
    chosen = [{p.name: choice} for p in method.params for choice in (*p.choices, *p.of)]
    variants = (method.variant(params) for params in ({}, *chosen))
    return {r.name: r for v in variants for r in (*v.buffers, *v.targets) if r.name not in declared}


def _contents(methods: Iterable[Method]) -> Iterable[tuple[str, ...]]:
    """A row for each different buffer or target, with the methods that declare it; then what parameters add."""
    declared: dict[tuple[str, ...], list[str]] = {}
    added: dict[str, Buffer | Target] = {}
    for method in methods:
        for resource in (*method.buffers, *method.targets):
            declared.setdefault((f"`{resource.name}`", _size(resource), resource.doc), []).append(f"`{method.id}`")
        added |= _added(method)
    for row, ids in declared.items():
        yield *row, ", ".join(ids)
    for name, resource in added.items():
        yield f"`{name}`", _size(resource), resource.doc, "by parameters"


def _whole(methods: Iterable[Method]) -> Iterable[tuple[str, str]]:
    """A row for each method that `touched` does not limit, or not in every pass, with the reason."""
    for method in methods:
        if method.untouched:
            yield f"`{method.id}`", f"no such parameter: {method.untouched}"
        variants = [method.variant({p.name: choice}) for p in method.params for choice in p.choices]
        passes = dict.fromkeys((step.name, step.whole) for v in variants for step in v.passes if step.whole)
        yield from ((f"`{method.id}`", f"{name}: {why}") for name, why in passes)


def as_markdown(methods: Iterable[Method]) -> str:
    """docs/methods.md: what each method is, promises and costs; its parameters; what becomes of equal depths."""
    methods = list(methods)
    lines = [HEAD, "## What they are", ""]
    lines += markdown_table(("id", "name in the papers", "what", "source"),
                            ((f"`{m.id}`", m.name, m.summary, m.source) for m in methods))
    lines += ["", "## What they promise and cost", ""]
    lines += markdown_table(("id", "guarantee", "error at most, units of 2^-24", "words", "passes", "needs"),
                            ((f"`{m.id}`", _promise(m), _bound(m), f"`{m.words}`",
                              ", ".join(m.pass_names), _needs(m)) for m in methods))
    lines += ["", "## What is allocated in addition to the words, or how they are used", ""]
    lines += markdown_table(("id", "in addition to the words"), ((f"`{m.id}`", m.beside) for m in methods if m.beside))
    lines += ["", "## What buffers and targets contain", "", CONTENTS, ""]
    lines += markdown_table(("name", "size", "contents", "methods"), _contents(methods))
    lines += ["", "## Why some take more than three times as long as the fastest A-buffer", ""]
    lines += markdown_table(("id", "reason"), ((f"`{m.id}`", m.cost) for m in methods if m.cost))
    lines += ["", "## What the parameter `touched` leaves as it is", ""]
    lines += markdown_table(("id", "pass: reason"), _whole(methods))
    lines += ["", "## Equal depths", ""]
    lines += markdown_table(("id", "fragments of equal depth"), ((f"`{m.id}`", m.ties) for m in methods))
    lines += ["", "## Parameters", ""]
    lines += markdown_table(("id", "parameters: the default (what is allowed)"),
                            ((f"`{m.id}`", "; ".join(f"{p.name}: {p.default} ({p.allowed})" for p in m.params))
                             for m in methods if m.params))
    return "\n".join(lines) + "\n"

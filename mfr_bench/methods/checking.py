"""Finds what is wrong with a declaration by itself: guarantees, names of resources, names in formulas."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import get_args

from ..errors import one_of
from .spec import IMAGE, Method
from .spec.formulas import FUNCTIONS
from .spec.method import ONE, Guarantee
from .spec.passes import Loop

CAPACITY = ("capacity", "k", "f_k")  # names of formulas that the method's capacity and its k bring


@dataclass(frozen=True)
class Mistake:
    """A mistake in a method's declaration, and the text in its file that is wrong."""

    text: str
    what: str


def mistakes_of(method: Method) -> Iterator[Mistake]:
    """Everything that is wrong with a declaration, as far as the declaration alone tells."""
    guarantees = get_args(Guarantee)
    if method.guarantee not in guarantees:
        yield Mistake(method.guarantee, f"the guarantee {method.guarantee!r} is none; "
                                        f"{one_of(str(method.guarantee), guarantees)}")
    yield from _wrong_resources(method)
    yield from _wrong_formulas(method)


def _wrong_resources(method: Method) -> Iterator[Mistake]:
    """Names that a pass reads, writes or draws into, and that neither the method nor the pass declares."""
    shared = [each.name for each in (*method.buffers, *method.targets)]
    own = [each.name for step in method.passes for each in (*step.buffers, *step.targets)]
    known = dict.fromkeys([*shared, *own, IMAGE])
    for step in method.passes:
        for name in (*step.reads, *step.writes, *step.into):
            if name.partition(".")[0] not in known:
                yield Mistake(name, f"pass {step.name} uses {name!r}, which is no buffer or target of the method; "
                                    f"{one_of(name, known)}")
        for name in step.texels:
            if name not in step.reads:
                yield Mistake(name, f"pass {step.name} has {name!r} in texels, and does not read it; "
                                    f"{one_of(name, step.reads)}")
        for name in step.pairs:
            if name not in step.texels:
                yield Mistake(name, f"pass {step.name} has {name!r} in pairs, and not in texels; "
                                    f"{one_of(name, step.texels)}")


def _wrong_formulas(method: Method) -> Iterator[Mistake]:
    known = dict.fromkeys([*(p.name for p in (*method.params, *method.fixed)), *ONE.names, *CAPACITY, *FUNCTIONS])
    for where, formula in _formulas(method):
        try:
            names = _names_in(formula)
        except SyntaxError:
            yield Mistake(formula, f"the formula {formula!r} of {where} cannot be read; allowed: arithmetic over names")
        else:
            yield from (Mistake(formula, f"the formula {formula!r} of {where} has the name {name!r}; "
                                         f"{one_of(name, known)}") for name in names if name not in known)


def _formulas(method: Method) -> Iterator[tuple[str, str]]:
    """Every formula of a method, and what it is of."""
    yield "the paper's words", method.words
    yield "local", method.local
    for buffer in (*method.buffers, *(b for step in method.passes for b in step.buffers)):
        yield f"buffer {buffer.name}", buffer.words
    for step in method.passes:
        yield f"the instances of pass {step.name}", step.instances
        yield from ((f"pass {step.name}", formula) for formula in (step.groups, step.needed) if formula)
    yield from (("a loop's times", step.times) for step in method.steps if isinstance(step, Loop))


def _names_in(formula: str) -> Iterable[str]:
    tree = ast.parse(formula, mode="eval")
    return dict.fromkeys(node.id for node in ast.walk(tree) if isinstance(node, ast.Name))

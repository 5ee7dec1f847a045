"""Finds the methods that may keep a question's bounds, by what they declare; and for each of the others the reason."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from ..methods.spec import Method, Param, Planned, Value
from ..report.advice import written_as
from .question import Question

PREPARING_S = 0.6  # seconds to compile, draw and check a candidate where nothing is known of the device
PREPARING_SHARE = 0.6  # of the time, at most, for that
NOT_TRIED = "not tried within the time budget; a larger --time-budget tries it"
NOT_FINISHED = "not finished within the time budget; a larger --time-budget does it"
SHALLOW = (2, 4, 8, 16, 32, 64)  # k that is tried where an error is allowed
FEW_REGISTERS = 32  # fragments up to which sorting in registers is tried


@dataclass(frozen=True)
class Candidate:
    """A method with the parameters that it races with."""

    method: str
    label: str
    params: Mapping[str, Value]

    @property
    def written(self) -> str:
        """The method as a config or a command takes it: its id, and the parameters."""
        return written_as(self.method, self.params)


@dataclass(frozen=True)
class Excluded:
    """A method that cannot keep the bounds, as a config or a command takes it, and why."""

    method: str
    reason: str


def candidates(catalog: Mapping[str, Method], question: Question,
               enough: int | None = None) -> tuple[list[Candidate], list[Excluded]]:
    """The candidates, and the methods that are excluded by what they declare.

    `enough`: how many of the nearest layers keep the error, where a model of the scene tells (see `model`); without it
    several numbers are tried. What a device lacks and what memory a scene needs is judged later, by the plan of the
    run, which says so.
    """
    found: list[Candidate] = []
    excluded: list[Excluded] = []
    for method in catalog.values():
        if method.guarantee == "none":
            continue
        mine = [Candidate(method.id, _label(method, params), params) for params in _choices(method, question, enough)]
        if mine:
            found += mine
        else:
            excluded.append(Excluded(method.id, _reason(method, question)))
    return found, excluded


def within_time(found: list[Candidate], excluded: list[Excluded], budget_s: float,
                forbidden: Collection[str] = ()) -> tuple[list[Candidate], list[Excluded]]:
    """Keep as many candidates as can be compiled and checked in the time; the others are excluded for lack of it.

    A method's first candidate comes before any method's second. A device that takes longer than expected tries fewer of
    them, in this order: the run forecasts each by those before it. forbidden: the labels of those that the plan of the
    run forbids, which take no time and are all kept.
    """
    turns: dict[str, int] = {}
    ranked = []
    for each in found:
        turns[each.method] = turns.get(each.method, 0) + 1
        ranked.append((turns[each.method], len(ranked), each))
    room = max(2, int(PREPARING_SHARE * budget_s / PREPARING_S))
    ordered = [each for *_, each in sorted(ranked, key=lambda entry: entry[:2])]
    able = [each for each in ordered if each.label not in forbidden]
    late = [Excluded(each.written, NOT_TRIED) for each in able[room:]]
    return [*able[:room], *(each for each in ordered if each.label in forbidden)], [*excluded, *late]


def _reason(method: Method, question: Question) -> str:
    if method.guarantee.startswith("exact"):
        return f"keeps fewer fragments of a pixel than the {question.layers} that may be there"
    return method.failure or f"promises no more than {method.guarantee}"


def _choices(method: Method, question: Question, enough: int | None) -> list[dict[str, Value]]:
    """Parameters with which the method may keep the error, each once. Those at their defaults are left out."""
    found: list[dict[str, Value]] = []
    for params in _all_choices(method, question, enough):
        if params not in found:
            found.append(params)
    return found


def _all_choices(method: Method, question: Question, enough: int | None) -> Iterator[dict[str, Value]]:
    k = method.param("k")
    if method.guarantee.startswith("exact"):
        if k is not None:
            for kept in _kept(k, question, enough):
                yield from _sorted_ways(method, {"k": kept}, question)
        elif (layers := method.variant({}).layers) is None or layers >= question.layers:
            yield from _sorted_ways(method, {}, question)
            yield from _within_memory(method, question)
            yield from _cut_short(method, question)
    elif not question.exact:
        yield from ({"k": kept} for kept in _kept(k, question, enough)) if k is not None else ({},)


def _within_memory(method: Method, question: Question) -> Iterator[dict[str, Value]]:
    """A method that keeps a memory only where a parameter names it, with that of the question."""
    planned = method.capacity
    if question.memory_mb is not None and isinstance(planned, Planned) and planned.budget:
        yield {planned.budget: _near(method.param(planned.budget), question.memory_mb)}


def _cut_short(method: Method, question: Question) -> Iterator[dict[str, Value]]:
    """An exact method that may leave out as much as the error allows."""
    for name, value in (("max_error", question.max_error), ("stop_opacity", 1.0 - question.max_error)):
        param = method.param(name)
        if param is not None and not question.exact:
            yield {name: _near(param, value)}


def _kept(k: Param, question: Question, enough: int | None) -> list[int]:
    """The numbers of fragments per pixel to race with."""
    if question.exact:
        wanted = [question.layers]
    elif enough is not None:
        wanted = [enough]
    else:
        wanted = [kept for kept in SHALLOW if kept < question.layers] + [question.layers]
    return [max(int(k.low), kept) for kept in wanted if kept <= k.high]


def _sorted_ways(method: Method, params: dict[str, Value], question: Question) -> Iterator[dict[str, Value]]:
    """The parameters with the default sort, and with sorting in registers where that is offered."""
    yield params
    sort = method.param("sort")
    if sort is not None and sort.default != "register" and question.layers <= FEW_REGISTERS:
        yield params | {"sort": "register"}


def _near(param: Param, value: float) -> float:
    """The value, or the nearest one that the parameter takes."""
    least, most = param.low + 1e-6, param.high if param.closed else param.high - 1e-6
    return float(min(max(value, least), most))


def _label(method: Method, params: Mapping[str, Any]) -> str:
    said = ", ".join(f"{name} {value:.4g}" if isinstance(value, float) else f"{name} {value}"
                     for name, value in params.items())
    return f"{method.name} ({said})" if said else method.name

"""A broken promise as text: which fragments there were, what the pixel shows, and the interleaving line by line."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, zip_longest
from typing import Any

import numpy as np

from ..errors import MfrError
from ..glsl import read
from ..oracle.quality import pixel_errors
from .adapter import FramePass, locator
from .campaign import Found, settings, written
from .check import SAID, Checker, Event, Failure, payloads
from .promise import Kind, expected
from .sweep import Line

NEVER_WRITTEN = 0xA5A5A5A5  # what a word is before anybody writes it
MATCH = 2e-5  # of a channel: an image of known fragments
MOST_STEPS = 400  # of a printed trace; of a longer one, the beginning and the end are printed
MOST_EXPLAINED = 6  # fragments of a pixel, of which all selections are tried
WORD_NAMES = {2: "xy", 3: "xyz", 4: "xyzw"}


@dataclass(frozen=True)
class Step:
    """One line of a trace."""

    step: str  # name of the pass
    fragment: str
    place: str  # file:line
    source: str
    operation: str
    times: int = 1  # in a row


def selections(checker: Checker, failure: Failure) -> Iterator[tuple[int, tuple[int, ...], tuple[int, ...] | None]]:
    """Give, for each pixel that is wrong, its fragments, and those by which its colour comes about, or None."""
    errors = pixel_errors(failure.image, expected(checker.variant, checker.stats, checker.scene))[0]
    for x, error in enumerate(errors):
        inside = tuple(int(i) for i in np.flatnonzero(checker.scene.rect[:, 0] == x))
        if error > MATCH and len(inside) <= MOST_EXPLAINED:
            yield x, inside, _selection(checker, inside, failure.image[0, x])


def _selection(checker: Checker, inside: Sequence[int], colour: np.ndarray) -> tuple[int, ...] | None:
    nearest = sorted(inside, key=lambda i: float(checker.scene.depth[i]))
    for size in range(len(nearest) + 1):
        for chosen in combinations(nearest, size):
            if np.abs(_composited(checker, chosen) - colour).max() < MATCH:
                return chosen
    return None


def _composited(checker: Checker, fragments: Sequence[int]) -> np.ndarray:
    colour = np.zeros(4)
    for i in fragments:
        straight = checker.scene.rgba[i] / 255.0
        colour += (1 - colour[3]) * np.append(straight[:3] * straight[3], straight[3])
    return colour


def steps(checker: Checker, events: Sequence[Event]) -> list[Step]:
    """The trace of the passes whose fragments meet in memory."""
    describe = _Describer(checker)
    found: list[Step] = []
    for event in _stores_at_once(events):
        made = describe.step(event)
        if made and found and made == replace(found[-1], times=1):
            found[-1] = replace(found[-1], times=found[-1].times + 1)
        elif made:
            found.append(made)
    return found


def _stores_at_once(events: Sequence[Event]) -> Iterator[Event]:
    """The events; a store that reaches memory at once is one of them, on weak memory any other is on its way."""
    weak = any(event.operation == "reaches_memory" for event in events)
    before: Event | None = None
    for event, following in zip_longest(events, events[1:]):
        stored = event.operation == "store" and weak
        if stored and not (following and _arrives(event, following)):
            yield replace(event, stale=True)
        elif not (before and event.operation == "reaches_memory" and _arrives(before, event)):
            yield event
        before = event


def _arrives(stored: Event, event: Event) -> bool:
    """Whether an event is the arrival of what the event before it stored."""
    return (stored.operation, event.operation) == ("store", "reaches_memory") and (
        stored.fiber, stored.site, stored.buffer, stored.word) == (event.fiber, event.site, event.buffer, event.word)


def owners(what: str, values: Sequence[int]) -> dict[int, str]:
    """The name of each value: that of the one fragment that has it, or of all that do."""
    found: dict[int, list[str]] = {}
    for fragment, value in enumerate(values):
        found.setdefault(int(value), []).append(f"f{fragment}")
    return {value: f"{what} of {' and '.join(names)}" for value, names in found.items()}


class _Describer:
    def __init__(self, checker: Checker):
        self.checker = checker
        wider = checker.variant.payload_words - 1
        self.elements = {b.name: b.element_words + (wider if b.type in ("FRAGMENT", "PAYLOAD") else 0)
                         for b in checker.frame.buffers}
        _, codes = payloads(checker.scene, checker.variant.two_channel)
        depths = checker.scene.depth.view(np.uint32).tolist()
        self.known = {0xFFFFFFFF: "empty", NEVER_WRITTEN: "never written",
                      **owners("depth", depths), **owners("colour", codes.tolist())}

    def step(self, event: Event) -> Step | None:
        if event.site < 0:
            return None
        number, line = self.checker.built.sites[event.site]
        shown = self.checker.frame.passes[number]
        if shown.step.kind != "geometry" or not shown.concurrent:
            return None
        place = locator(shown.own)(line)
        return Step(shown.step.name, f"f{event.fiber}", place, source_line(shown, place), self._operation(event))

    def _operation(self, event: Event) -> str:
        if not event.buffer:
            return event.operation
        name = event.buffer if event.buffer != "diagnostics" else ("lost_fragments", "arrived_fragments",
                                                                   "held_fragments")[event.word]
        where = name if event.buffer == "diagnostics" else self._word(name, event.word)
        before, after = self._value(event.before), self._value(event.after)
        if event.operation == "load":
            return f"load {where}: {after}" + (" (an earlier value)" if event.stale else "")
        if event.operation == "store":
            return f"store {where} = {after}" + (", on its way" if event.stale else "")
        if event.operation == "reaches_memory":
            return f"reaches memory only now: {where} = {after}"
        changed = f"{before} -> {after}" if event.before != event.after else f"{before}, unchanged"
        return f"{event.operation} {where}: {changed}"

    def _word(self, name: str, word: int) -> str:
        words = self.elements.get(name.partition("_previous")[0], 1)
        return f"{name}[{word}]" if words == 1 else f"{name}[{word // words}].{WORD_NAMES[words][word % words]}"

    def _value(self, value: int) -> str:
        if value in self.known:
            return self.known[value]
        return str(value) if value < 2**16 else f"0x{value:08x}"


def source_line(shown: FramePass, place: str) -> str:
    """The text of a line of a shader; empty where it is of the prelude."""
    path, _, line = place.partition(":")
    if not line.isdigit():
        return ""
    try:
        lines = read(path).splitlines()
    except MfrError:
        return ""
    return lines[int(line) - 1].strip() if 0 < int(line) <= len(lines) else ""


def headline(found: Found) -> str:
    """One line: what was run, and what came out."""
    checker, variant = found.checker, found.checker.variant
    said = " ".join(f"{name}={value}" for name, value in settings(variant).items())
    what = f"{variant.method.id}{' ' + said if said else ''}: {found.schedules} schedules in {found.seconds:.1f} CPU s"
    if checker.promised.kind is Kind.NONE:
        share = f"{100 * found.failed / found.schedules:.1f} %"
        return f"{what}; it promises nothing, and {found.failed} of them ({share}) have a wrong pixel"
    if found.failure is None:
        return f"{what}; every one gives {checker.promised.kind.value}"
    return f"{what}; broken: {SAID.get(found.failure.what, found.failure.what)}"


def campaign_line(line: Line) -> str:
    """A line of a campaign: configuration, machine, schedules, violations or share of wrong ones, speed."""
    said = " ".join(f"{name}={value}" for name, value in json.loads(line.params).items())
    what = f"{line.machine:8} {line.method:19} {said:30}"
    if line.error:
        return f"{what} {line.error}"
    promised = line.wrong_share is None
    shown = f"{line.violations} violations" if promised else f"{100 * line.wrong_share:.1f} % wrong, promised nothing"
    again = f"  --replay {line.replay}" if line.replay else ""
    return f"{what} {line.schedules:9,} schedules, {shown}, {line.schedules_per_s:9,.0f} schedules/s{again}"


def campaign_end(lines: Sequence[Line], cores: int) -> str:
    """The last line of a campaign: sums, the CPU time of the schedules, and that time on so many cores."""
    configurations = len({(line.method, line.params) for line in lines})
    minutes = sum(line.cpu_s for line in lines) / 60
    unknown = sum(bool(line.error) for line in lines)
    tried = (f"{sum(line.schedules for line in lines):,} schedules in {minutes:.1f} CPU minutes "
             f"({minutes / cores:.1f} minutes on {cores} cores)")
    violations = f"{sum(line.violations for line in lines)} violations"
    ended = [violations, f"{unknown} could not be run"] if unknown else [violations]
    least = min((line.schedules for line in lines), default=0)
    said = f"{configurations} configurations, {len(lines)} lines of {least:,} schedules or more"
    return ", ".join([said, tried, *ended])


def text(found: Found, again: str = "") -> str:
    """The headline, and of a broken promise all that a person needs to follow it; `again`: the command to replay it."""
    if found.failure is None or found.checker.promises_nothing:
        return headline(found)
    checker, failure = found.checker, found.failure
    return "\n".join([headline(found), "", *_fragment_lines(checker), *_pixel_lines(checker, failure), "",
                      *_trace_lines(steps(checker, failure.events)), *_end_lines(checker, failure), "",
                      f"again: {again} --replay {written(checker.scene.seed, failure.deviations)}"])


def _fragment_lines(checker: Checker) -> Iterator[str]:
    scene = checker.scene
    for i, (rect, depth, rgba) in enumerate(zip(scene.rect, scene.depth, scene.rgba, strict=True)):
        yield f"f{i}: pixel {rect[0]}, depth {float(depth):g}, rgba {' '.join(map(str, rgba))}"


def _pixel_lines(checker: Checker, failure: Failure) -> Iterator[str]:
    if failure.what == "lost_fragments":
        yield f"lost_fragments: {failure.lost}"
    if failure.what != "wrong_image":
        return
    for x, inside, shown in selections(checker, failure):
        names = ", ".join(f"f{i}" for i in shown) if shown is not None else "no selection of its fragments"
        yield f"pixel {x} shows {names or 'nothing'} of {', '.join(f'f{i}' for i in inside)}"


def _trace_lines(trace: Sequence[Step]) -> Iterator[str]:
    width = max((len(s.place) for s in trace), default=0)
    before: Step | None = None
    left_out = len(trace) - MOST_STEPS
    for at, s in enumerate(trace):
        if left_out > 0 and at == MOST_STEPS // 2:
            yield f"  ... {left_out} accesses more ..."
        if left_out > 0 and MOST_STEPS // 2 <= at < MOST_STEPS // 2 + left_out:
            continue
        if before is None or s.step != before.step:
            yield f"pass {s.step}"
        new = before is None or (s.fragment, s.place) != (before.fragment, before.place)
        if new:
            yield f"  {s.fragment:4}{s.place:{width}}  {s.source}"
        yield f"      {'':{width}}    {s.operation}{f', {s.times} times' if s.times > 1 else ''}"
        before = s


def _end_lines(checker: Checker, failure: Failure) -> Iterator[str]:
    """The access at which the schedule failed, where it is one that the trace lacks."""
    if failure.what.startswith("out_of_bounds") and failure.site >= 0:
        number, line = checker.built.sites[failure.site]
        shown = checker.frame.passes[number]
        place = locator(shown.own)(line)
        yield f"  f{failure.fiber}  {place}  {source_line(shown, place)}"
        yield f"      {SAID[failure.what]}, at word {failure.value}"


def record(found: Found) -> dict[str, Any]:
    """The object that `race --json` prints."""
    checker, failure = found.checker, found.failure
    broken = failure is not None and not checker.promises_nothing
    return {
        "method": checker.variant.method.id, "params": checker.variant.params, "promise": checker.promised.kind.value,
        "schedules": found.schedules, "seconds": found.seconds, "failed": found.failed, "lost": found.lost,
        "complete": found.complete, "broken": broken, "failure": failure.what if broken and failure else None,
        "replay": written(checker.scene.seed, failure.deviations) if broken and failure else None,
        "fragments": [{"pixel": int(r[0]), "depth": float(d), "rgba": [int(c) for c in rgba]}
                      for r, d, rgba in zip(checker.scene.rect, checker.scene.depth, checker.scene.rgba, strict=True)],
        "trace": [vars(s) for s in steps(checker, failure.events)] if broken and failure else [],
    }

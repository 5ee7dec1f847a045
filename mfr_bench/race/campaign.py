"""Several scenes and machines for one variant: the runs that a command, a test or a campaign is made of."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..errors import UsageError, nearest
from ..methods.spec import Method, Variant
from .check import Checker, Deviation, Failure, How
from .scenes import row_of

SMALL_K = 2  # fragments kept, where nothing else is said: below the number that a pixel of a small scene has
SCENES = 8
KINDS = "sndrvwl"  # of a choice, in the machine's order: switch, next, delay, reach, value, word order, lane
_CHOICE = re.compile(rf"(-?\d+)@(\d+)\.(\d+):([{KINDS}])(\d+)")
ACCESS_BITS = 20  # of a choice's key; the bits above are the step of the frame


@dataclass(frozen=True)
class Found:
    """The outcome of the schedules of all scenes, and the first broken promise with the checker that found it."""

    schedules: int
    seconds: float
    failed: int
    wrong: int
    lost: int
    complete: bool
    checker: Checker
    failure: Failure | None

    @property
    def broken(self) -> bool:
        return self.failure is not None


def small_variant(method: Method, overrides: Sequence[str]) -> Variant:
    """The variant of `KEY=VALUE` settings, with a small k. Raises UsageError, one line for each mistake."""
    chosen: dict[str, Any] = {"k": SMALL_K} if method.param("k") else {}
    mistakes = []
    for text in overrides:
        key, equals, value = text.partition("=")
        param = method.param(key.strip().removeprefix("params."))
        if not equals or param is None:
            names = [p.name for p in method.params]
            mistakes.append(f"--set {text}: {method.id} has no parameter {key.strip()!r}; allowed: "
                            f"{', '.join(names)}{nearest(key.strip(), names)}")
            continue
        try:
            chosen[param.name] = param.parse(_value(value.strip()))
        except ValueError as error:
            mistakes.append(f"--set {key}: {error}")
    if mistakes:
        raise UsageError(mistakes)
    return method.variant(chosen)


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text


def checkers(variant: Variant, counts: Sequence[int], scenes: int, ties: bool = False,
             helpers: bool = False) -> Iterator[Checker]:
    """The variant in scenes of as many fragments per pixel, with other colours and another order in each."""
    first = None
    for seed in range(1, scenes + 1):
        made = Checker(variant, row_of(counts, seed, ties), helpers, first)
        first = first or made
        yield made


def run(variant: Variant, counts: Sequence[int], how: How, scenes: int = SCENES, ties: bool = False) -> Found:
    """Schedules spread over scenes, until one breaks a promise. A promise of nothing is counted to the end."""
    total = Found(0, 0.0, 0, 0, 0, True, None, None)
    for checker in checkers(variant, counts, scenes, ties, how.helpers):
        each = replace(how, schedules=-(-how.schedules // scenes), seed=how.seed + checker.scene.seed)
        if checker.promises_nothing:
            each = replace(each, count_all=True)
        outcome = checker.check(each)
        total = Found(total.schedules + outcome.schedules, total.seconds + outcome.seconds,
                      total.failed + outcome.failed, total.wrong + outcome.wrong, total.lost + outcome.lost,
                      total.complete and outcome.complete, checker, outcome.failure)
        if outcome.failure:
            break
    return total


def written(scene: int, deviations: Sequence[Deviation]) -> str:
    """A scene and the choices of a schedule as one word, for `--replay`."""
    mask = (1 << ACCESS_BITS) - 1
    choices = [f"{fiber}@{count >> ACCESS_BITS}.{count & mask}:{KINDS[kind]}{value}"
               for fiber, count, kind, value in deviations]
    return ",".join([str(scene), *choices])


def parse_replay(text: str) -> tuple[int, tuple[Deviation, ...]]:
    """The scene and the choices of `written`. Raises UsageError."""
    scene, *choices = text.split(",")
    matches = [_CHOICE.fullmatch(choice) for choice in choices]
    if not scene.isdigit() or not all(matches):
        raise UsageError(f"--replay: {text!r} is no schedule; allowed: the word that race prints behind --replay")
    return int(scene), tuple((int(m[1]), int(m[2]) << ACCESS_BITS | int(m[3]), KINDS.index(m[4]), int(m[5]))
                             for m in matches if m)


def settings(variant: Variant, *without: str) -> Mapping[str, Any]:
    """The parameters that are not at their defaults, `without` those of these names."""
    defaults = variant.method.complete({})
    return {name: value for name, value in variant.params.items() if value != defaults[name] and name not in without}

"""The types of a manifest's entries, as far as anything reads them: a program or a hand may have left others."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from .record import flat, is_number

Test = Callable[[Any], bool]


def text(value: Any) -> bool:
    return isinstance(value, str)


def truth(value: Any) -> bool:
    return isinstance(value, bool)


def scalar(value: Any) -> bool:
    """Whether it is null, a text, a truth value or a number."""
    return not isinstance(value, list) and flat(value)


def list_of(test: Test) -> Test:
    return lambda value: isinstance(value, list) and all(map(test, value))


def mapping_of(test: Test) -> Test:
    return lambda value: isinstance(value, Mapping) and all(map(test, value.values()))


def record_of(tests: Mapping[str, Test]) -> Test:
    """Whether it is a mapping whose members, where they are there and not null, pass their tests."""
    return lambda value: isinstance(value, Mapping) and not wrong_members(value, tests)


def wrong_members(record: Mapping[str, Any], tests: Mapping[str, Test]) -> list[str]:
    """Names of the members that do not pass their tests."""
    return [name for name, test in tests.items() if record.get(name) is not None and not test(record[name])]


DEVICE = record_of(dict.fromkeys(("renderer", "vendor", "version", "slug", "kind"), text))
FIGURE = {
    **dict.fromkeys(("kind", "x", "y", "rows", "log", "title", "x_label", "y_label", "panels", "gain_of", "fit",
                     "printed"), text),
    "log_base": lambda value: is_number(value) and value > 1, "methods": list_of(text), "passes": list_of(text),
    "floor": truth, "bound": truth, "sorted": truth,
}
ANSWER = {"key": text, "confidence": is_number}
MANIFEST = {
    **dict.fromkeys(("name", "title", "config", "timer", "started", "calibration_drift"), text),
    "source": mapping_of(flat), "scene": mapping_of(lambda value: True), "params": mapping_of(scalar),
    "sweep": mapping_of(list_of(flat)), "zip": mapping_of(list_of(flat)), "measure": mapping_of(flat),
    "cells": list_of(text), "places": list_of(is_number),
    "methods": list_of(record_of({"id": text, "label": text, "params": mapping_of(scalar)})),
    "device": lambda value: text(value) or DEVICE(value), "versions": mapping_of(scalar),
    "packages": list_of(mapping_of(scalar)), "environment": mapping_of(lambda value: True),
    "answer": lambda value: value == {} or (record_of(ANSWER)(value) and ANSWER.keys() <= value.keys()),
    "split_s": mapping_of(is_number), "beside_s": mapping_of(is_number), "left_out": mapping_of(is_number),
    "refused": lambda value: is_number(value) and value >= 0,
    "calibration": mapping_of(lambda value: True), "calibration_end": mapping_of(lambda value: True),
    "merged": list_of(mapping_of(lambda value: True)), "noise_floor_rel": lambda value: is_number(value) and value >= 0,
}


def sound(manifest: Mapping[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """The manifest without what is not of its type, and where that is."""
    wrong = wrong_members(manifest, MANIFEST)
    kept = {name: value for name, value in manifest.items() if name not in wrong}
    figures = kept.get("figures")
    if figures is not None and not isinstance(figures, list):
        return {name: value for name, value in kept.items() if name != "figures"}, [*wrong, "figures"]
    good = []
    for number, figure in enumerate(figures or []):
        bad = wrong_members(figure, FIGURE) if isinstance(figure, Mapping) else [""]
        wrong += [f"figures[{number}].{name}".rstrip(".") for name in bad]
        good += [] if bad else [figure]
    return kept | ({"figures": good} if figures is not None else {}), wrong

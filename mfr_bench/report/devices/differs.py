"""Differences between the devices of an experiment besides their times: a reader must know them to compare."""

from __future__ import annotations

from .reading import Experiment

FACTS = {"driver": "driver", "clock": "clock (MHz)", "timer": "timer", "size": "viewport", "profile": "profile",
         "program": "mfr-bench", "day": "measured", "simulated": "simulated"}
MOST_VALUES = 6  # of one fact that are listed; of more, how many there are
UNKNOWN = "not recorded"


def differences(experiment: Experiment) -> list[tuple[str, list[tuple[str, list[str]]]]]:
    """Each fact in which devices differ: its values, and the devices that have each."""
    found = []
    for fact, title in FACTS.items():
        values: dict[str, list[str]] = {}
        for device in experiment.devices:
            values.setdefault(_text(device.facts.get(fact)), []).append(device.name)
        if len(values) > 1:
            found.append((title, sorted(values.items(), key=lambda item: -len(item[1]))))
    return found


def common(experiment: Experiment) -> list[tuple[str, str]]:
    """Each fact that all devices share, with its value."""
    values = {title: {_text(device.facts.get(fact)) for device in experiment.devices} for fact, title in FACTS.items()}
    return [(title, *found) for title, found in values.items() if len(found) == 1 and found != {"no"}]


def lacking(experiment: Experiment) -> list[tuple[str, int]]:
    """Devices that lack cells which others have, and how many."""
    most = len({place for device in experiment.devices for place in device.places})
    return [(device.name, most - len(device.places)) for device in experiment.devices if len(device.places) < most]


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return UNKNOWN if value in (None, "") else str(value)

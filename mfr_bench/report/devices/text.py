"""Devices compared, as text for a terminal, Markdown and JSON."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from functools import cache
from typing import Any

from .. import data
from ..data import number
from ..tables.grid import Grid, bulleted, cut
from .answer import Answer, Row
from .differs import MOST_VALUES, common, differences, lacking
from .reading import Experiment
from .standing import MOST_DEVICES, Standing

MOST_NAMES = 3  # devices that are named for a value
STANDING_NOTE = ("over all scenes: ratio to the time of the device's fastest method, geometric mean; first: devices on "
                 "which it is the fastest; rank: the median over devices, and the least and the largest; the right "
                 "images alone count")
RANK_NOTE = "1 the fastest; in brackets the ranks that the intervals and the noise floor leave open"


def as_text(experiment: Experiment, width: int, markdown: bool = False) -> str:
    """The devices of an experiment, how the methods stand on them, and what differs."""
    head = f"{experiment.name}: {_count(len(experiment.devices), 'device')}"
    parts = [f"# {head}" if markdown else head]
    for grid in _grids(experiment):
        if grid.rows:
            parts += _shown(grid, width, markdown)
    parts += [f"## {title}\n\n" + "\n".join(f"- {line}" for line in lines) if markdown else
              "\n".join([title, *bulleted(lines, width)]) for title, lines in _lists(experiment) if lines]
    return "\n\n".join(parts) + "\n"


def _shown(grid: Grid, width: int, markdown: bool) -> list[str]:
    if markdown:
        return [f"## {grid.title}", grid.note, *(chunk.markdown() for chunk in grid.chunks(width))]
    notes = textwrap.wrap(f"({grid.note})", width)
    return ["\n".join([grid.title, *notes, "\n\n".join(chunk.text() for chunk in grid.chunks(width))])]


def _grids(experiment: Experiment) -> Iterable[Grid]:
    standing = Standing(experiment)
    rows = standing.by_entry()
    several = len(experiment.devices) > 1
    yield Grid("Methods over all devices", STANDING_NOTE,
               ("method", "devices", "first", "rank", "ratio", "worst ratio", "worst on"),
               tuple((cut(entry), str(found["devices"]), str(found["first"]), _range(found), number(found["ratio"]),
                      number(found["worst_ratio"]), experiment.devices[found["worst_on"]].name)
                     for entry, found in rows))
    if several and len(experiment.devices) <= MOST_DEVICES:
        places = [(entry, experiment.entries.index(entry)) for entry, _ in rows]
        yield Grid("Rank on each device", RANK_NOTE, ("method", *(device.name for device in experiment.devices)),
                   tuple((cut(entry), *(_rank(standing.rank[i, at]) for i in range(len(experiment.devices))))
                         for entry, at in places))


def _range(found: Mapping[str, float]) -> str:
    low, middle, high = (f"{found[name]:g}" for name in ("rank_low", "rank", "rank_high"))
    return middle if low == high else f"{middle} [{low}, {high}]"


def _rank(rank: Sequence[float]) -> str:
    low, middle, high = rank
    if math.isnan(middle):  # not measured there
        return "–"
    return f"{middle:.0f}" if low == high else f"{middle:.0f} [{low:.0f}, {high:.0f}]"


def _lists(experiment: Experiment) -> Iterable[tuple[str, list[str]]]:
    yield "What differs between the devices", [*map(_difference, differences(experiment)), *_missing(experiment)]
    yield "What they have in common", [f"{title}: {value}" for title, value in common(experiment)]
    damaged = [line for device in experiment.devices for line in device.damaged]
    yield "Files not used", damaged


def _difference(found: tuple[str, list[tuple[str, list[str]]]]) -> str:
    title, values = found
    shown = [f"{value} ({_named(names)})" for value, names in values[:MOST_VALUES]]
    more = f"; and {len(values) - MOST_VALUES} more values" if len(values) > MOST_VALUES else ""
    return f"{title}: {'; '.join(shown)}{more}"


def _missing(experiment: Experiment) -> list[str]:
    found: dict[int, list[str]] = {}
    for name, count in lacking(experiment):
        found.setdefault(count, []).append(name)
    shown = [f"{_count(count, 'cell')} on {_named(names)}" for count, names in sorted(found.items())[:MOST_VALUES]]
    more = f"; other numbers on {sum(map(len, found.values()))} devices in all" if len(found) > MOST_VALUES else ""
    said = f"cells that others measured with the right image, and these did not: {'; '.join(shown)}{more}"
    return [said] if found else []


def _named(names: Sequence[str]) -> str:
    if len(names) <= MOST_NAMES:
        return ", ".join(names)
    return f"{', '.join(names[:MOST_NAMES - 1])} and {len(names) - MOST_NAMES + 1} more"


def _count(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"


# --- answers ---------------------------------------------------------------------------------------


def answers_text(found: Sequence[Answer], width: int) -> str:
    """A paragraph for each scene."""
    return "\n\n".join("\n".join(_answer_lines(answer, found, width)) for answer in found)


def _answer_lines(answer: Answer, found: Sequence[Answer], width: int) -> Iterable[str]:
    where = place_words(answer.place, tuple(a.place for a in found if a.experiment == answer.experiment))
    yield from textwrap.wrap(f"{answer.experiment} on {len(answer.devices)} devices{f', {where}' if where else ''}: "
                             f"{answer.limits}", width, break_on_hyphens=False)
    for line in _said(answer):
        yield from textwrap.wrap(line, width, initial_indent="  ", subsequent_indent="    ", break_on_hyphens=False)


def _said(answer: Answer) -> Iterable[str]:
    worst, longest, near = answer.best_on_worst, answer.shortest_longest, answer.near_on_all
    if worst is None:
        yield "Nothing measured keeps this on every device."
    else:
        yield (f"Best on the worst device: {worst.entry}, at most {number(worst.worst_ratio)} times a device's best "
               f"({worst.worst_on}).")
        yield f"Shortest of the longest times: {longest.entry}, {number(longest.longest_ms)} ms ({longest.longest_on})."
        share = data.percent(answer.within)
        yield (f"Within {share} of the best on all devices: " + ("; ".join(
            f"{row.entry} (at most {number(row.worst_ratio)} times)" for row in near) or "none") + ".")
        if not near:
            most = max(answer.rows, key=lambda row: (row.within, -row.worst_ratio))
            yield f"Within {share} on most: {most.entry}, on {most.within} of {len(answer.devices)}."
    if answer.partly:
        yield ("Kept or measured on some devices only: "
               + "; ".join(f"{entry} on {count}" for entry, count in answer.partly) + ".")


@cache
def place_words(place: str, others: tuple[str, ...]) -> str:
    """A scene in words: what tells it from the other scenes of its experiment."""
    mine, *_ = _scenes((place,))
    every = _scenes(others)
    names = [name for name in mine if any(scene.get(name) != mine[name] for scene in every)]
    return ", ".join(data.heading(name, _plain(mine[name])) for name in names if mine[name] is not None)


def _scenes(places: Iterable[str]) -> list[dict[str, Any]]:
    return [json.loads(place) for place in places]


def _plain(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value if not isinstance(value, dict) else json.dumps(value)


def answers_json(found: Sequence[Answer]) -> str:
    """A list with an object for each scene; `best_on_worst` is null where nothing keeps the limits on every device."""
    return json.dumps([_record(answer) for answer in found], indent=2, ensure_ascii=False)


def _row(row: Row | None) -> dict[str, Any] | None:
    return None if row is None else asdict(row)


def _record(answer: Answer) -> dict[str, Any]:
    return {"experiment": answer.experiment, "scene": json.loads(answer.place), "devices": list(answer.devices),
            "limits": asdict(answer.limits), "within": answer.within, "best_on_worst": _row(answer.best_on_worst),
            "shortest_longest": _row(answer.shortest_longest), "near_on_all": [asdict(r) for r in answer.near_on_all],
            "methods": [asdict(row) for row in answer.rows], "partly": dict(answer.partly)}

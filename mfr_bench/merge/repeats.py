"""One cell measured by several equal devices: samples that are equivalent are added up, others are kept apart."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from ..stats import ratio_interval, sampled_interval
from ..store.record import NODE, Cell, parsed, text
from .copies import Copy, Source

VALUES = "values."  # before the name of a measured value
EQUIVALENT = 0.05  # relative: samples are added up where the interval of every ratio lies within it


@dataclass(frozen=True)
class Settled:
    """The outcome of a key: its cell with content and arrays, the records that it was made of, and a line on that."""

    cell: Cell
    content: bytes
    arrays: bytes | None
    originals: tuple[bytes, ...] = ()  # where several devices measured it
    said: str | None = None


def settled(key: str, copies: Sequence[Copy], replicates: Sequence[bytes], target: Source) -> Settled | str:
    """One record for a key, or a line on why there can be none. Neither depends on the order of `copies`.

    replicates: the records of several devices that a merge before kept in `target`.
    """
    earlier = [Copy(key, content, None, target) for content in replicates]
    made = _made_of(earlier)
    parts = {copy.digest: copy for copy in (*earlier, *copies) if copy.digest not in made}
    ordered = [copy for _, copy in sorted(parts.items())]
    if len(ordered) == 1:
        return Settled(ordered[0].cell, ordered[0].content, ordered[0].arrays)
    if wrong := _contradiction(key, ordered):
        return wrong
    contents = tuple(copy.content for copy in ordered)
    content, apart = _joined(ordered)
    how = (f"{len(contents)} devices differ {apart}: the one with most samples stands, the others are kept in "
           "replicates/" if apart else f"samples of {len(contents)} devices are added up")
    fitting = [copy for copy in copies if copy.content == content] if apart else copies
    arrays = next((copy.arrays for copy in sorted(fitting, key=lambda c: c.digest) if copy.arrays), None)
    return Settled(parsed(content), content, arrays, contents, f"cell {key}: {how}")


def _made_of(earlier: Sequence[Copy]) -> set[str]:
    """Digest of the record that a merge before added up from these, which is no measurement of its own."""
    if not earlier:
        return set()
    joined, _ = _joined(sorted(earlier, key=lambda copy: copy.digest))
    return {hashlib.sha256(joined).hexdigest()} - {copy.digest for copy in earlier}


def _contradiction(key: str, copies: Sequence[Copy]) -> str | None:
    """The reason why records of one key cannot be repetitions of one measurement, or None.

    Several devices may differ in values, as methods do whose image depends on the order in which pixels are drawn.
    """
    for first, other in combinations(copies, 2):
        both = f"cell {key} differs between {first.source.folder.path} and {other.source.folder.path}"
        names = _differing(first.result, other.result)
        if first.node == other.node or not all(name.startswith(VALUES) for name in names):
            what = ', '.join(names) or "its times"
            told = "" if first.node != other.node else (
                ", and nothing tells the devices apart (UUID, PCI address, node)")
            return f"{both} in {what}{told}; allowed: one of them"
    return None


def _differing(one: Mapping[str, Any], other: Mapping[str, Any]) -> list[str]:
    names = [f"{VALUES}{name}" for name in sorted({*one["values"], *other["values"]})
             if one["values"].get(name) != other["values"].get(name)]
    return names + [name for name in sorted({*one, *other} - {"values"}) if one.get(name) != other.get(name)]


def _joined(copies: Sequence[Copy]) -> tuple[bytes, str | None]:
    """The record of all samples together where they are equivalent, else the one with most samples and what differs."""
    cells = [parsed(copy.content) for copy in copies]
    names = sorted({name for other in copies[1:] for name in _differing(copies[0].result, other.result)})
    if not names and _equivalent([cell.get("samples_ms") or [] for cell in cells]):
        return text(_pooled(cells)), None
    most = max(range(len(cells)), key=lambda i: (len(cells[i].get("samples_ms") or ()), copies[i].content))
    return copies[most].content, f"in {', '.join(names)}" if names else f"by more than {100 * EQUIVALENT:.0f} %"


def _equivalent(samples: Sequence[Sequence[float]]) -> bool:
    """Whether the interval of each set's ratio to all others together lies within EQUIVALENT of 1."""
    for i, own in enumerate(samples):
        others = [value for j, each in enumerate(samples) if j != i for value in each]
        low, _, high = ratio_interval(own, others)
        if low is None or high is None or low < 1 / (1 + EQUIVALENT) or high > 1 + EQUIVALENT:
            return False
    return True


def _pooled(cells: Sequence[dict[str, Any]]) -> dict[str, Any]:
    first = cells[0]
    samples = [value for cell in cells for value in cell["samples_ms"]]
    low, middle, high = sampled_interval(samples)
    passes = {name: [value for cell in cells for value in (cell.get("passes") or {}).get(name, [])]
              for name in dict.fromkeys(name for cell in cells for name in cell.get("passes") or {})}
    values = first["values"] | {
        "samples": len(samples), "time_ms": middle, "time_ms_low": low, "time_ms_high": high,
        "sessions": sum(cell["values"].get("sessions") or 1 for cell in cells)}
    device = dict(first.get("device") or {}) | dict.fromkeys(NODE)
    return first | {"values": values, "samples_ms": samples, "passes": passes, "device": device}

"""The records that a result folder brings to a merge, each checked against the key that names it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from ..store import KEY_FILE, ResultFolder
from ..store.record import NODE, Cell, Shared, cell_key, fault, other_schema, parsed

REPEATED = frozenset({  # what another run of the same cell gives anew
    "warmup_ms", "samples_ms", "references_ms", "aside_ms", "passes", "measured", "device"})
REPEATED_VALUES = frozenset({
    "samples", "time_ms", "time_ms_low", "time_ms_high", "noisy", "stop_reason", "repeats", "sessions",
    "distinct_images"})


@dataclass(frozen=True)
class Copy:
    """One record of a cell: its bytes, those of its arrays, and the folder that has them."""

    key: str
    content: bytes
    arrays: bytes | None
    source: Source = field(repr=False)

    @cached_property
    def digest(self) -> str:
        """Name of the content: equal copies have equal digests."""
        return hashlib.sha256(self.content).hexdigest()

    @cached_property
    def cell(self) -> Cell:
        """The record, parsed once."""
        return parsed(self.content, self.source.shared)

    @property
    def node(self) -> tuple[str | None, ...]:
        """The identity of the device among equal ones: UUID and PCI address."""
        device = device_of(self.cell)
        return tuple(device.get(name) for name in NODE)

    @property
    def result(self) -> dict[str, Any]:
        """The part that every repetition of the cell agrees on: the record without times and the node."""
        kept = {name: value for name, value in self.cell.items() if name not in REPEATED}
        values = {name: value for name, value in kept["values"].items() if name not in REPEATED_VALUES}
        device = {name: value for name, value in device_of(self.cell).items() if name not in NODE}
        return kept | {"values": values, "device": device}


@dataclass(frozen=True)
class Source:
    """A result folder to merge: its manifest and the digest of that."""

    folder: ResultFolder
    manifest: Mapping[str, Any]
    shared: Shared = field(default_factory=Shared, repr=False, compare=False)

    @classmethod
    def of(cls, folder: ResultFolder) -> Source:
        return cls(folder, folder.manifest())

    @property
    def name(self) -> str:
        return str(self.manifest.get("name") or self.folder.path.name)

    @property
    def slug(self) -> str:
        """Name of the device, which names the folder above the set."""
        return str(device_of(self.manifest).get("slug") or "unknown-device")

    def copies(self) -> Iterator[Copy | str]:
        """Every record of the folder, or a line on what keeps it from being one. Nothing in the folder is changed."""
        for copy in self.files():
            yield copy if isinstance(copy, str) else self.fault(copy) or copy

    def files(self) -> Iterator[Copy | str]:
        """Every file of a cell in the folder, unchecked, or a line on why it cannot be read."""
        names, content = self.folder.names(), self.folder.reader()
        there = frozenset(names)
        for name in filter(KEY_FILE.fullmatch, names):
            key = name.removesuffix(".json")
            yield self._copy(key, content, f"{key}.npz" in there)

    def fault(self, copy: Copy) -> str | None:
        """A line on what keeps a file from being a record that can be used, or None."""
        try:
            wrong = other_schema(copy.cell) or fault(copy.cell, copy.key)
        except ValueError as error:
            wrong = f"cannot be read: {error}"
        return self._left_out(copy.key, wrong) if wrong else None

    def contradiction(self, copy: Copy) -> str | None:
        """The contradiction of a record with its own key or its folder, or None."""
        cell, timer = copy.cell, self.manifest.get("timer")
        device = device_of(cell)
        if not device_of(self.manifest).get("slug"):
            return "has no device in the manifest of its folder, or that cannot be read"
        if device.get("slug") not in (None, self.slug):
            return f"was measured on {device['slug']}, its folder on {self.slug}"
        if timer is not None and cell_key(cell, timer) != copy.key:
            return "is not what its key names (method, shaders, parameters, scene, settings, device, driver, timer)"
        return None

    def _copy(self, key: str, content: Callable[[str], bytes], with_arrays: bool) -> Copy | str:
        try:
            return Copy(key, content(f"{key}.json"), self._arrays(key, content) if with_arrays else None, self)
        except (OSError, ValueError) as error:
            return self._left_out(key, f"cannot be read: {error}")

    def _left_out(self, key: str, wrong: str) -> str:
        return f"{self.folder.path}: cell {key}: {wrong}; left out"

    @staticmethod
    def _arrays(key: str, content: Callable[[str], bytes]) -> bytes | None:
        try:
            return content(f"{key}.npz")
        except (OSError, ValueError):
            return None


def device_of(record: Mapping[str, Any]) -> Mapping[str, Any]:
    """The device of a cell or a manifest; of the older ones that have its name alone, that name."""
    device = record.get("device")
    return device if isinstance(device, Mapping) else {"slug": device}

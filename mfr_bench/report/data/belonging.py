"""Finds the cells of a folder that its config has: a config changed since leaves rows that belong to it no longer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...methods import FLOOR
from ...store import Cell

WORDS = {True: "on", False: "off"}  # as YAML reads them


class Config:
    """The statement of a manifest about the cells of its config. One that does not list its methods has every cell."""

    def __init__(self, manifest: Mapping[str, Any]):
        self._planned = set(manifest.get("cells") or ())
        self._entries = manifest.get("methods")
        self._params, self._scene = manifest.get("params") or {}, manifest.get("scene") or {}
        self._zip = manifest.get("zip") or {}
        self._axes = {**(manifest.get("sweep") or {}), **self._zip}

    def has(self, cell: Cell) -> bool:
        """Whether the config plans the cell, or would if it measured every method here with every device."""
        if cell["key"] in self._planned or self._entries is None:
            return True
        return self._has_scene(cell) and self._has_point(cell["point"]) and self._has_method(cell)

    def _has_scene(self, cell: Cell) -> bool:
        """Whether the scene is the config's in all that no axis sets; r = n / k sets the depth complexity."""
        free = {name.partition(".")[2] for name in self._axes}
        if "r" in {**self._axes, **self._params}:
            free.add("depth_complexity")
        swept = all(name in cell["point"] for name in self._axes if name.startswith("scene."))
        return swept and all(cell["scene"].get(name, value) == value for name, value in self._scene.items()
                             if name not in free)

    def _has_point(self, point: Mapping[str, Any]) -> bool:
        if not all(value in self._axes.get(name, ()) for name, value in point.items()):
            return False
        zipped = [{i for i, v in enumerate(self._zip[name]) if v == value}
                  for name, value in point.items() if name in self._zip]
        return not zipped or bool(set.intersection(*zipped))

    def _has_method(self, cell: Cell) -> bool:
        return cell["method"] == FLOOR or any(
            (entry.get("id"), entry.get("label")) == (cell["method"], cell["label"])
            and self._has_params(cell, entry.get("params") or {}) for entry in self._entries)

    def _has_params(self, cell: Cell, given: Mapping[str, Any]) -> bool:
        """Whether the parameters are those that the entry and the config give, apart from the swept ones."""
        swept = {name for name in self._axes if name not in given}
        fixed = {name: value for name, value in {**self._params, **given}.items() if name not in swept}
        own = cell["params"]
        return (all(WORDS.get(value, value) == own[name] if isinstance(value, bool) else value == own[name]
                    for name, value in fixed.items() if name in own)
                and all(name in cell["point"] for name in swept if name in own))

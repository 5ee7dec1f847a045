"""The merged set on disk: cells byte for byte, a manifest of all manifests, the originals of what was added up."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..store import Cell
from ..store.pack import remove, write_pack
from .plan import Merged, decide, refuse

DESIGN = ("scene", "params", "sweep", "zip", "methods", "measure")  # what makes one config of a name another


@dataclass(frozen=True)
class Written:
    """The number of cells that a set has now, of those that are new in its folder, and of the folders merged.

    said: a line for each cell that several devices measured. records: the cells, as `ResultFolder.cells` gives them,
    where the merge read every file of the folder.
    """

    cells: int
    new: int
    folders: int
    said: tuple[str, ...]
    records: list[Cell] | None


def write_set(merged: Merged) -> Written:
    """Write the cells, their originals and the manifest of a set. Raises StoreError; a merge again then goes on.

    The caller has the folder's lock. What the folders have by now counts: UsageError where records contradict each
    other, as none did when the set was checked.
    """
    decided = decide(merged)
    refuse(decided.wrong, f"nothing was merged into {merged.folder.path}")
    folder, files = merged.folder, {}
    for key, cell in decided.cells.items():
        files[f"{key}.json"] = cell.content
        files |= {f"{key}.npz": cell.arrays} if cell.arrays else {}
        for content in cell.originals:
            folder.write_replicate(key, content)
    there = {name: folder.content(name) for name in folder.names()}
    new = {name: content for name, content in files.items() if there.get(name) != content}
    if decided.packed and (new or not folder.pack_path.exists() or folder.loose()):
        write_pack(folder.pack_path, {**there, **files})
        remove([folder.cells_path / name for name in folder.loose() if name in {**there, **files}])
    elif not decided.packed:
        folder.write_contents(new)
    manifest = joined_manifest(source.manifest for source in decided.sources)
    if manifest != folder.manifest():
        folder.write_manifest(manifest)
    return Written(len(decided.cells), sum(name.endswith(".json") and name not in there for name in new),
                   len(decided.sources), tuple(cell.said for cell in decided.cells.values() if cell.said),
                   None if decided.left_out else folder.in_order([cell.cell for cell in decided.cells.values()]))


def joined_manifest(manifests: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """One manifest for a set: what all agree on, every cell and figure, and each manifest whole under `merged`.

    It depends on the set of manifests alone: merging in another order, in steps or again gives the same one.
    """
    parts: dict[str, Mapping[str, Any]] = {}
    for manifest in manifests:
        for part in manifest.get("merged") or [manifest]:
            parts[_digest(part)] = part
    ordered = [part for _, part in sorted(parts.items(), key=lambda pair: (str(pair[1].get("started")), pair[0]))]
    first = dict(ordered[0])
    if len(ordered) == 1:
        return first
    one_design = all(part.get(name) == first.get(name) for part in ordered for name in DESIGN)
    joined = first | _cells(ordered, one_design) | {
        "figures": _distinct(figure for part in ordered for figure in part.get("figures") or ()),
        "noise_floor_rel": max(part.get("noise_floor_rel") or 0.0 for part in ordered) or None,
        "merged": ordered,
        **{name: _sums([part.get(name) or {} for part in ordered]) for name in ("split_s", "beside_s")}}
    if any(part.get("settings") != first.get("settings") for part in ordered):
        joined.pop("settings", None)  # no command measures all of it
    if not one_design:
        joined.pop("methods", None)  # without them every cell belongs to the set
    if any(part.get("device") != first.get("device") for part in ordered):
        joined["device"] = {name: value for name, value in dict(first.get("device") or {}).items()
                            if all((part.get("device") or {}).get(name) == value for part in ordered)}
    return joined


def _cells(parts: Sequence[Mapping[str, Any]], one_design: bool) -> dict[str, Any]:
    """The planned cells of all parts in the order of the whole plan, with their places in it.

    They are in the order of the parts where these do not tell places of one plan, as of a run with --only.
    """
    keys = list(dict.fromkeys(key for part in parts for key in part.get("cells") or ()))
    placed = {pair for part in parts for pair in zip(part.get("places") or (), part.get("cells") or (), strict=False)}
    plan = dict(sorted(placed))
    if not one_design or not len(plan) == len(placed) == len(keys):
        return {"cells": keys, "places": []}
    return {"cells": list(plan.values()), "places": list(plan)}


def _digest(part: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(part, sort_keys=True).encode()).hexdigest()


def _distinct(values: Iterable[Any]) -> list[Any]:
    found = {json.dumps(value, sort_keys=True): value for value in values}
    return list(found.values())


def _sums(parts: Sequence[Mapping[str, float]]) -> dict[str, float]:
    return {name: round(sum(part.get(name, 0.0) for part in parts), 3)
            for name in dict.fromkeys(name for part in parts for name in part)}

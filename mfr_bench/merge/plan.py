"""The plan of what a merge writes, decided before anything is written: sets by device and experiment, each key once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import UsageError
from ..store import ResultFolder
from .copies import Copy, Source
from .repeats import Settled, settled

SHOWN = 20  # contradictions of one merge that are listed; of more, the number


@dataclass
class Merged:
    """The set of one experiment on one device: where it goes, what it is made of, each key with what becomes of it."""

    folder: ResultFolder
    sources: list[Source] = field(default_factory=list)
    cells: dict[str, Settled] = field(default_factory=dict)

    @property
    def packed(self) -> bool:
        """Whether any of its folders is packed; the set is then as well."""
        return any(source.folder.pack_path.exists() for source in self.sources)


def merged_sets(folders: Sequence[ResultFolder], into: Path) -> tuple[list[Merged], list[str]]:
    """The sets that these folders and what `into` has already make, and a line for each record that is left out.

    A set goes to INTO/<device>/<experiment>/, as under results/; if all folders hold one experiment of one device, and
    INTO is no folder of sets, it goes to INTO itself. The order of `folders` does not matter.

    Raises UsageError where records contradict their keys, their folders or each other; nothing is written then.
    """
    sources = [Source.of(folder) for folder in folders]
    sets = _sets(sources, into)
    left_out, wrong = [], []
    for merged in sets:
        _settle(merged, left_out, wrong)
    _refuse(wrong, "nothing was merged")
    return sets, left_out


def decide_again(merged: Merged) -> None:
    """Decide a set anew, whose folder another process may have written to since. The caller has the folder's lock.

    Raises UsageError where that contradicts what was to be written.
    """
    merged.sources = [Source.of(source.folder) for source in merged.sources if source.folder is not merged.folder]
    merged.cells = {}
    wrong: list[str] = []
    _settle(merged, [], wrong)
    _refuse(wrong, f"nothing was merged into {merged.folder.path}")


def _refuse(wrong: Sequence[str], end: str) -> None:
    if wrong:
        more = [f"and {len(wrong) - SHOWN} more"] if len(wrong) > SHOWN else []
        raise UsageError([*wrong[:SHOWN], *more, end])


def _sets(sources: Iterable[Source], into: Path) -> list[Merged]:
    places: dict[tuple[str, str], list[Source]] = {}
    for source in sources:
        places.setdefault((source.slug, source.name), []).append(source)
    there = Source.of(ResultFolder(into))
    if there.manifest and {*places} != {(there.slug, there.name)}:
        raise UsageError(f"--into {into}: is the set {there.name} of {there.slug}; allowed: that set alone, or a "
                         "folder that holds sets")
    alone = len(places) == 1 and (there.manifest or not into.exists() or not any(into.iterdir()))
    return [Merged(ResultFolder(into if alone else into / _file_name(slug) / _file_name(name)), found)
            for (slug, name), found in sorted(places.items())]


def _file_name(name: str) -> str:
    """A name from a manifest as that of one folder, whatever it holds. Raises UsageError where it can be none."""
    if not name or name.startswith(".") or any(c in name for c in "/\\\0"):
        raise UsageError(f"a manifest names its device or experiment {name!r}, which is no name of a folder")
    return name


def _settle(merged: Merged, left_out: list[str], wrong: list[str]) -> None:
    """Decide what becomes of every key of a set; what is already in its folder counts like any other source."""
    target = merged.folder
    if target.path.is_dir() and target.manifest() and target.path.resolve() not in {
            source.folder.path.resolve() for source in merged.sources}:
        there, mine = Source.of(target), merged.sources[0]
        if (there.slug, there.name) != (mine.slug, mine.name):
            wrong.append(f"{target.path}: is the set {there.name} of {there.slug}, not {mine.name} of {mine.slug}")
        merged.sources.append(there)
    found: dict[str, dict[str, Copy]] = {}
    for source in merged.sources:
        for copy in source.copies():
            if isinstance(copy, str):
                left_out.append(copy)
            elif contradiction := source.contradiction(copy):
                wrong.append(f"{source.folder.path}: cell {copy.key} {contradiction}")
            else:
                found.setdefault(copy.key, {}).setdefault(copy.digest, copy)
    for key, copies in sorted(found.items()):
        outcome = settled(key, list(copies.values()), target)
        if isinstance(outcome, str):
            wrong.append(outcome)
        else:
            merged.cells[key] = outcome

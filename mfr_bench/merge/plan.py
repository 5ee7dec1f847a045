"""The plan of what a merge writes, decided before anything is written: sets by device and experiment, each key once."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ..errors import UsageError
from ..parallel import in_processes
from ..store import ResultFolder
from .copies import Copy, Source
from .repeats import Settled, settled

SHOWN = 20  # contradictions of one merge that are listed; of more, the number


@dataclass(frozen=True)
class Merged:
    """The set of one experiment on one device: where it goes, and the folders that it is made of.

    checked: what tells the files of these folders, which were all checked and found right, from any others.
    """

    folder: ResultFolder
    sources: tuple[Source, ...]
    checked: str | None = None


@dataclass(frozen=True)
class Decided:
    """Each key of a set with what becomes of it, the folders that it comes from, with what was in its place already.

    left_out: a line for each record that cannot be used; wrong: for each that contradicts its key, its folder or
    another. state: the files that it was decided by, as `Merged.checked` has it.
    """

    sources: Sequence[Source]
    cells: Mapping[str, Settled]
    left_out: Sequence[str]
    wrong: Sequence[str]
    state: str

    @property
    def packed(self) -> bool:
        """Whether any of its folders is packed; the set is then as well."""
        return any(source.folder.pack_path.exists() for source in self.sources)


def merged_sets(folders: Sequence[ResultFolder], into: Path) -> tuple[list[Merged], list[str]]:
    """The sets that these folders and what `into` has already make, and a line for each record that is left out.

    A set goes to INTO/<device>/<experiment>/, as under results/; if all folders hold one experiment of one device, and
    INTO is no folder of sets, it goes to INTO itself. The order of `folders` does not matter. Every record is checked
    here, and none is kept: what becomes of it is decided again where it is written, of the same files without checking
    each anew.

    Raises UsageError where records contradict their keys, their folders or each other; nothing is written then.
    """
    sets = _sets([Source.of(folder) for folder in folders], into)
    left_out: list[str] = []
    wrong: list[str] = []
    checked = []
    for merged, (skipped, mistakes, state) in zip(sets, in_processes(_checked, sets), strict=True):
        left_out += skipped
        wrong += mistakes
        checked.append(replace(merged, checked=None if skipped or mistakes else state))
    refuse(wrong, "nothing was merged")
    return checked, left_out


def _checked(merged: Merged) -> tuple[Sequence[str], Sequence[str], str]:
    decided = decide(merged)
    return decided.left_out, decided.wrong, decided.state


def refuse(wrong: Sequence[str], end: str) -> None:
    """Raise UsageError with what is wrong, if anything is, and what became of the merge."""
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
    return [Merged(ResultFolder(into if alone else into / _file_name(slug) / _file_name(name)), tuple(found))
            for (slug, name), found in sorted(places.items())]


def _file_name(name: str) -> str:
    """A name from a manifest as that of one folder, whatever it holds. Raises UsageError where it can be none."""
    if not name or name.startswith(".") or any(c in name for c in "/\\\0"):
        raise UsageError(f"a manifest names its device or experiment {name!r}, which is no name of a folder")
    return name


def decide(merged: Merged) -> Decided:
    """Decide what becomes of every key of a set; what is already in its folder counts like any other source.

    The folders are opened anew and read as they are now.
    """
    left_out: list[str] = []
    wrong: list[str] = []
    target = ResultFolder(merged.folder.path)
    sources = [Source.of(ResultFolder(source.folder.path)) for source in merged.sources]
    if target.path.is_dir() and target.manifest() and target.path.resolve() not in {
            source.folder.path.resolve() for source in sources}:
        there, mine = Source.of(target), sources[0]
        if (there.slug, there.name) != (mine.slug, mine.name):
            wrong.append(f"{target.path}: is the set {there.name} of {there.slug}, not {mine.name} of {mine.slug}")
        sources.append(there)
    read = [(source, list(source.files())) for source in sources]
    state = _state(read)
    found = _copies(read, left_out, wrong, checked=state == merged.checked)
    return Decided(sources, _settled(found, target, wrong), left_out, wrong, state)


Read = Sequence[tuple[Source, Sequence[Copy | str]]]  # each source with its files, or lines on why one cannot be read


def _state(read: Read) -> str:
    """A hash of everything that the check of these records reads."""
    found = hashlib.sha256()
    for source, copies in read:
        found.update(repr((str(source.folder.path), source.slug, source.manifest.get("timer"))).encode())
        found.update(repr([copy if isinstance(copy, str) else (copy.key, copy.digest) for copy in copies]).encode())
    return found.hexdigest()


def _copies(read: Read, left_out: list[str], wrong: list[str], checked: bool) -> dict[str, dict[str, Copy]]:
    """The sound records of all sources by key and digest; checked: they were found sound before."""
    found: dict[str, dict[str, Copy]] = {}
    for source, copies in read:
        for copy in copies:
            if isinstance(copy, str):
                left_out.append(copy)
            elif not checked and (unusable := source.fault(copy)):
                left_out.append(unusable)
            elif not checked and (contradiction := source.contradiction(copy)):
                wrong.append(f"{source.folder.path}: cell {copy.key} {contradiction}")
            else:
                found.setdefault(copy.key, {}).setdefault(copy.digest, copy)
    return found


def _settled(found: Mapping[str, Mapping[str, Copy]], target: ResultFolder, wrong: list[str]) -> dict[str, Settled]:
    cells, replicates, at = {}, target.replicates(), Source.of(target)
    for key, copies in sorted(found.items()):
        outcome = settled(key, list(copies.values()), replicates.get(key, ()), at)
        if isinstance(outcome, str):
            wrong.append(outcome)
        else:
            cells[key] = outcome
    return cells

"""A bundle from result folders: records checked, personal details removed, and no more than a collection takes."""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import UsageError
from ..merge.copies import Copy, Source
from ..store import ResultFolder
from ..store.pack import zipped
from ..store.record import cell_key, parsed, text
from .archive import BUNDLE_BYTES, INDEX, MEMBER, index_of
from .personal import cleaned, names, pattern


def make_bundle(folders: Sequence[ResultFolder], signed_off: str) -> tuple[bytes, list[str]]:
    """The bytes of a bundle of these results, and a line for each record that it leaves out.

    Raises UsageError where a record contradicts its key, where what would be removed is part of a key (the path of a
    mesh) or of a set's name, where a manifest names no timer, where two folders are one set, where nobody signs off,
    and where the bundle would be too large.
    """
    if not signed_off.strip():
        raise UsageError("--sign-off: nobody signs off; allowed: the name of who vouches for these results")
    personal = pattern(names())
    files: dict[str, bytes] = {}
    said: list[str] = []
    for source in map(Source.of, folders):
        where = f"{source.slug}/{source.name}"
        if f"{where}/manifest.json" in files:
            raise UsageError(f"{source.folder.path}: a second set {where}; allowed: one of each; "
                             "'mfr-bench merge' joins them")
        if not MEMBER.fullmatch(f"{where}/cells.zip"):
            raise UsageError(f"{source.folder.path}: {where!r} is no name of a set; allowed: letters, digits, _ . + -")
        if personal.search(where):
            raise UsageError(f"{source.folder.path}: the set is named {where!r}, with a name of this machine or its "
                             "user in it; allowed: a config of another name")
        if source.manifest.get("timer") is None:
            raise UsageError(f"{source.folder.path}: its manifest names no timer, which is part of every key; allowed: "
                             "results whose manifest 'mfr-bench run' wrote")
        files[f"{where}/manifest.json"] = text(cleaned(source.manifest, personal))
        files[f"{where}/cells.zip"] = zipped(_clean_cells(source, personal, said))
    content = zipped({INDEX: index_of(files, signed_off), **files})
    if len(content) > BUNDLE_BYTES:
        raise UsageError(f"the bundle has {len(content) >> 20} MiB; allowed: {BUNDLE_BYTES >> 20} MiB; send fewer")
    return content, said


def _clean_cells(source: Source, personal, said: list[str]) -> dict[str, bytes]:
    found: dict[str, bytes] = {}
    for copy in source.copies():
        if isinstance(copy, str):
            said.append(copy)
            continue
        if wrong := source.contradiction(copy):
            raise UsageError(f"{source.folder.path}: cell {copy.key} {wrong}")
        found[f"{copy.key}.json"] = _clean_record(source, copy, personal)
        if copy.arrays:
            found[f"{copy.key}.npz"] = copy.arrays
    return found


def _clean_record(source: Source, copy: Copy, personal) -> bytes:
    """The record without personal details; byte for byte where it has none. Raises UsageError."""
    cell = parsed(copy.content)
    clean = cleaned(cell, personal)
    if cell_key(clean, source.manifest["timer"]) != copy.key:
        raise UsageError(f"{source.folder.path}: cell {copy.key}: a path or a name of this machine is part of its key; "
                         "allowed: files beside the config, named without a path")
    return copy.content if clean == cell else text(clean)

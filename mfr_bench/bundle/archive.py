"""The file of a bundle: a zip with a fixed layout, read member by member within limits, whatever it says of itself.

    bundle.json                          schema, sign-off, sha256 of every other member
    <device>/<experiment>/manifest.json
    <device>/<experiment>/cells.zip      as `mfr-bench pack` writes it
"""

from __future__ import annotations

import hashlib
import io
import re
import zipfile
from collections.abc import Mapping
from pathlib import Path
from stat import S_ISDIR, S_ISREG
from typing import Any

from ..config.check import MAX_CELLS
from ..errors import UsageError
from ..store.columns import ARRAYS
from ..store.pack import BROKEN
from ..store.record import ARRAY_FILE, KEY_FILE, is_cell_file, parsed, text

SCHEMA = 1
INDEX = "bundle.json"
MEMBER = re.compile(r"[\w+-][\w.+-]{0,99}/[\w+-][\w.+-]{0,99}/(manifest\.json|cells\.zip)", re.ASCII)
BUNDLE_BYTES = 64 * 2**20  # of the file
MEMBERS = 20_000  # in a bundle
OPENED_BYTES = 512 * 2**20  # of all members together, unpacked, with the arrays in them
PIECE_BYTES = 2**20
END_BYTES = 22
ENTRY, END, END_64 = b"PK\x01\x02", b"PK\x05\x06", b"PK\x06\x07"  # an entry of a zip's index, the index's end


class Budget:
    """Bytes that may still be unpacked; a member counts by what it gives, not by what its header says."""

    def __init__(self, left: int = OPENED_BYTES):
        self.left = left

    def read(self, archive: zipfile.ZipFile, info: zipfile.ZipInfo) -> bytes:
        """One member. Raises ValueError where it is damaged or the budget ends."""
        found = io.BytesIO()
        try:
            with archive.open(info) as member:
                while piece := member.read(PIECE_BYTES):
                    self.left -= len(piece)
                    if self.left < 0:
                        raise ValueError(f"unpacks to more than {OPENED_BYTES >> 20} MiB")
                    found.write(piece)
        except NotImplementedError as error:
            raise ValueError(f"{info.filename}: {error}") from error
        except BROKEN as error:
            raise ValueError(str(error) or f"{info.filename}: damaged") from error
        return found.getvalue()


def read_bundle(path: Path) -> dict[str, dict[str, bytes]]:
    """The files of each set by '<device>/<experiment>': manifest.json and those of its pack.

    Raises UsageError, in one line, where the file is no bundle, is too large in any respect, has a member that does not
    belong in one, or differs from its own list of hashes. Nothing is written.
    """
    try:
        return _read(path)
    except FileNotFoundError:
        raise UsageError(f"{path}: no such file; allowed: a bundle that 'mfr-bench submit-results' wrote") from None
    except IsADirectoryError:
        raise UsageError(f"{path}: a folder; allowed: a bundle, one .zip; of results in this folder it is made by: "
                         f"mfr-bench submit-results {path} --sign-off \"YOUR NAME\" --out bundle.zip") from None
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (ValueError, zipfile.BadZipFile) as error:
        raise UsageError(f"{path}: {error}; refused; allowed: what 'mfr-bench submit-results' writes") from error


def _read(path: Path) -> dict[str, dict[str, bytes]]:
    found = path.stat()
    if S_ISDIR(found.st_mode):
        raise IsADirectoryError
    if not S_ISREG(found.st_mode):
        raise ValueError("is no file")
    size = found.st_size
    if size > BUNDLE_BYTES:
        raise ValueError(f"has {size >> 20} MiB, more than {BUNDLE_BYTES >> 20} MiB")
    budget = Budget()
    members = _members(path.read_bytes(), budget, MEMBERS, lambda name: name == INDEX or bool(MEMBER.fullmatch(name)))
    _check_hashes(members)
    sets: dict[str, dict[str, bytes]] = {}
    for name, content in members.items():
        where, _, file = name.rpartition("/")
        if file == "manifest.json":
            if len(planned := _planned(content)) > MAX_CELLS:
                raise ValueError(f"{name}: names {len(planned)} cells, more than {MAX_CELLS}")
            sets.setdefault(where, {})[file] = content
        elif file == "cells.zip":
            sets.setdefault(where, {}).update(_cells(content, budget))
    return sets


def _planned(manifest: bytes) -> list[Any]:
    """The cells that a manifest plans; none where it is none, as is told where it is used."""
    try:
        found = parsed(manifest)
    except ValueError:
        return []
    cells = found.get("cells") if isinstance(found, dict) else None
    return cells if isinstance(cells, list) else []


def _cells(content: bytes, budget: Budget) -> dict[str, bytes]:
    """The files of a pack. Arrays are zips of their own: what those give counts as well."""
    found = _members(content, budget, 2 * MAX_CELLS, is_cell_file)
    if (cells := sum(map(bool, map(KEY_FILE.fullmatch, found)))) > MAX_CELLS:
        raise ValueError(f"has {cells} cells in one set, more than {MAX_CELLS}")
    for name, packed in found.items():
        if ARRAY_FILE.fullmatch(name):
            try:
                _members(packed, budget, len(ARRAYS), {f"{array}.npy" for array in ARRAYS}.__contains__)
            except zipfile.BadZipFile as error:
                raise ValueError(f"{name}: {error}") from error
    return found


def _members(content: bytes, budget: Budget, most: int, belongs) -> dict[str, bytes]:
    if (count := _most_members(content)) > most:
        raise ValueError(f"has {count} members, more than {most}")
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        found: dict[str, bytes] = {}
        for info in archive.infolist():
            if not belongs(info.filename) or info.filename in found:
                raise ValueError(f"has a member {info.filename[:80]!r} that no bundle has, or has it twice")
            found[info.filename] = budget.read(archive, info)
    return found


def _most_members(content: bytes) -> int:
    """A bound on the number of members of a zip, without an object for each: a short one unpacks to millions."""
    last = len(content) - END_BYTES  # where it is unless a comment follows
    end = last if content.startswith(END, max(0, last)) else content.rfind(END)
    size = int.from_bytes(content[end + 12:end + 16], "little")
    beyond = content[max(0, end - 20):end].startswith(END_64)  # the size is told elsewhere
    return content.count(ENTRY, 0 if beyond else max(0, end - size), max(0, end))


def _check_hashes(members: Mapping[str, bytes]) -> None:
    index = parsed(members.get(INDEX, b"null"))
    if not isinstance(index, dict) or index.get("schema") != SCHEMA or not isinstance(index.get("sha256"), dict):
        raise ValueError(f"has no {INDEX} of schema {SCHEMA}")
    found = {name: hashlib.sha256(content).hexdigest() for name, content in members.items() if name != INDEX}
    wrong = [name for name in sorted({*found, *index["sha256"]}) if found.get(name) != index["sha256"].get(name)]
    if wrong:
        raise ValueError(f"{wrong[0][:80]}: not of the hash that {INDEX} names")


def index_of(files: Mapping[str, bytes], signed_off: str) -> bytes:
    """The content of bundle.json for these members."""
    return text({"schema": SCHEMA, "signed_off": signed_off,
                 "sha256": {name: hashlib.sha256(content).hexdigest() for name, content in sorted(files.items())}})

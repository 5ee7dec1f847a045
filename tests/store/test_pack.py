"""The packed form of a folder: the same bytes, read by everything, and never lost between the two forms."""

import copy
import os
import zipfile
from functools import partial

import numpy as np
import pytest

from mfr_bench import store
from mfr_bench.errors import StoreError
from mfr_bench.store.arrays import read_arrays, write_arrays

from .test_store import cell

NAMES = ("a", "b", "c")
KEEPING = cell("b")["key"]


@pytest.fixture
def folder(tmp_path):
    made = store.ResultFolder(tmp_path / "planted")
    for name in NAMES:
        made.write_cell(cell(name))
    write_arrays(made, KEEPING, {"error": np.full((2, 3), 0.25)})
    made.write_manifest({"name": "planted", "cells": [cell(name)["key"] for name in reversed(NAMES)]})
    return made


def files(folder):
    return {path.name: path.read_bytes() for path in folder.cells_path.iterdir()} if folder.cells_path.exists() else {}


def test_unpacked_is_as_before_to_the_byte(folder):
    before, cells = files(folder), folder.cells()
    assert folder.pack() == 3 and not folder.cells_path.exists() and folder.pack_path.is_file()
    assert folder.cells() == cells and store.ResultFolder(folder.path).cells() == cells
    assert read_arrays(folder, KEEPING)["error"].tolist() == [[0.25] * 3] * 2
    assert read_arrays(folder, cell("a")["key"]) == {} and folder.damaged == []
    assert copy.deepcopy(folder).cells() == cells
    assert folder.unpack() == 3 and files(folder) == before and not folder.pack_path.exists()


def test_the_same_cells_make_the_same_pack(folder, tmp_path):
    folder.pack()
    first = folder.pack_path.read_bytes()
    folder.unpack()
    folder.pack()
    assert folder.pack_path.read_bytes() == first


def test_a_cell_measured_again_counts_before_the_packed_one(folder):
    folder.pack()
    folder.write_cell(cell("a", values={"time_ms": 9.0}))
    folder.write_cell(cell("d"))
    assert {c["key"]: c["values"]["time_ms"] for c in folder.cells()} == {
        cell("a")["key"]: 9.0, **{cell(n)["key"]: 2.0 for n in "bcd"}}
    assert folder.pack() == 4 and not folder.cells_path.exists()
    assert folder.cell(cell("a")["key"])["values"]["time_ms"] == 9.0
    folder.write_cell(cell("c", values={"time_ms": 7.0}))
    folder.unpack()
    assert folder.cell(cell("c")["key"])["values"]["time_ms"] == 7.0


@pytest.mark.parametrize("work", ["pack", "unpack"])
def test_a_process_that_dies_at_any_call_loses_nothing(folder, monkeypatch, work):
    """Every call that writes, renames, syncs or deletes is the last one once."""
    cells = folder.cells()
    if work == "unpack":
        folder.pack()
    ended = False
    for last in range(60):
        left = [last]

        def dying(*arguments, real, left=left, **more):
            if left[0] == 0:
                raise KeyboardInterrupt
            left[0] -= 1
            return real(*arguments, **more)

        with monkeypatch.context() as patch:
            for call in ("fsync", "replace", "unlink", "rmdir", "mkdir"):
                patch.setattr(os, call, partial(dying, real=getattr(os, call)))
            try:
                getattr(store.ResultFolder(folder.path), work)()
                ended = True
            except KeyboardInterrupt:
                pass
        again = store.ResultFolder(folder.path)
        assert again.cells() == cells and read_arrays(again, KEEPING) and again.damaged == []
        if ended:
            break
    assert ended and last > 3


def test_a_damaged_pack_is_named_and_kept(folder):
    folder.pack()
    content = folder.pack_path.read_bytes()
    folder.pack_path.write_bytes(content[:len(content) // 2])
    broken = store.ResultFolder(folder.path)
    assert broken.cells() == [] and "cells.zip: cannot be read" in broken.damaged[0]
    for work in (broken.pack, broken.unpack):
        with pytest.raises(StoreError, match="cannot be read"):
            work()
    assert folder.pack_path.exists()


def test_a_damaged_file_in_a_pack_costs_its_cell_alone(folder):
    folder.pack()
    content = bytearray(folder.pack_path.read_bytes())
    name = f"{cell('a')['key']}.json".encode()
    start = content.index(name) + len(name) + 20
    content[start:start + 8] = b"damaged!"
    folder.pack_path.write_bytes(content)
    broken = store.ResultFolder(folder.path)
    assert {c["key"] for c in broken.cells()} == {cell("b")["key"], cell("c")["key"]}
    assert len(broken.damaged) == 1 and "damaged in cells.zip" in broken.damaged[0]
    for work in (broken.pack, broken.unpack):
        with pytest.raises(StoreError, match="nothing was changed"):
            work()


def test_a_pack_writes_nothing_outside_its_folder(folder):
    with zipfile.ZipFile(folder.pack_path, "w") as archive:
        archive.writestr("../../escaped.json", "{}")
        archive.writestr("notes.txt", "mine")
    assert store.ResultFolder(folder.path).unpack() == 0
    assert not (folder.path.parent.parent / "escaped.json").exists() and len(files(folder)) == 4


@pytest.mark.parametrize("packed", [False, True], ids=["loose", "packed"])
def test_what_a_newer_program_wrote_is_never_replaced(folder, packed):
    path = folder.cells_path / f"{cell('a')['key']}.json"
    newer = path.read_bytes().replace(b'"schema": 1', b'"schema": 2')
    path.write_bytes(newer)
    if packed:
        with zipfile.ZipFile(folder.pack_path, "w") as archive:
            archive.writestr(path.name, newer)
        path.unlink()
    with pytest.raises(StoreError, match="has schema 2, and this program writes 1: a newer mfr-bench"):
        folder.write_cell(cell("a"))
    with pytest.raises(StoreError, match="schema 2"), folder.lock():
        pass
    assert folder.content(path.name) == newer


def test_a_manifest_of_a_newer_program_is_never_replaced(folder):
    path = folder.path / "manifest.json"
    path.write_text('{"cells": [], "schema": 3}')
    with pytest.raises(StoreError, match="schema 3"):
        folder.write_manifest({"cells": []})
    with pytest.raises(StoreError, match="schema 3"), folder.lock():
        pass
    assert path.read_text() == '{"cells": [], "schema": 3}'

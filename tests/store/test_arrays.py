"""Arrays of cells: what is stored comes back, in its type; what another program left is no stumbling block."""

from __future__ import annotations

import os

import numpy as np
import pytest

from mfr_bench.config.settings import KEPT
from mfr_bench.store import ResultFolder
from mfr_bench.store.arrays import read_arrays, write_arrays
from mfr_bench.store.columns import ARRAYS

KEY = "0123456789abcdef0123"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "fsync", lambda _: None)
    return ResultFolder(tmp_path)


def some(name):
    shape = (5, 7, 4) if ARRAYS[name].dimensions == 3 else (5, 7)
    return np.random.default_rng(3).random(shape) * (1 if ARRAYS[name].type == "float16" else 200)


def test_every_array_that_a_config_may_keep_has_a_type():
    assert tuple(ARRAYS) == KEPT


@pytest.mark.parametrize("name", KEPT)
def test_an_array_comes_back_in_its_type(folder, name):
    write_arrays(folder, KEY, {name: some(name)})
    found = read_arrays(folder, KEY)
    assert list(found) == [name] and found[name].dtype == ARRAYS[name].type
    assert np.array_equal(found[name], some(name).astype(ARRAYS[name].type))
    assert not folder.damaged


def test_nothing_kept_is_no_file(folder):
    write_arrays(folder, KEY, {})
    assert not folder.arrays_path(KEY).exists() and read_arrays(folder, KEY) == {} and not folder.damaged


def test_an_array_file_is_no_stray_cell(folder):
    write_arrays(folder, KEY, {"error": some("error")})
    assert folder.cells() == [] and not folder.damaged


@pytest.mark.parametrize("wrong", [np.zeros(3, "float16"), np.zeros((2, 2), "float64"), np.zeros((0, 2), "float16")])
def test_an_array_of_another_kind_is_named_and_left_out(folder, wrong):
    folder.cells_path.mkdir()
    np.savez(folder.arrays_path(KEY), error=wrong, loss=np.zeros((2, 2), "float16"), other=np.zeros(2))
    assert list(read_arrays(folder, KEY)) == ["loss"]
    assert "error: not float16 of 2 dimensions" in folder.damaged[0]


def test_pickled_objects_are_refused(folder):
    folder.cells_path.mkdir()
    np.savez(folder.arrays_path(KEY), error=np.array([{}], dtype=object))
    assert read_arrays(folder, KEY) == {} and "cannot be read" in folder.damaged[0]

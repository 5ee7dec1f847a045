"""Parquet files: the same frames come back, with types, units and manifests; other files are refused in one line."""

from __future__ import annotations

import json
import sys

import fastparquet
import pandas as pd
import pytest

import mfr_bench
from mfr_bench.errors import MfrError, UsageError
from mfr_bench.parquet import KEY

from .cli.conftest import mfr  # noqa: F401  a fixture
from .report import planted


@pytest.fixture
def results(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    planted.folder(tmp_path / "results" / "planted", planted.sweep(ks=(4, 16)), sweep={"k": [4, 16]})
    return tmp_path


def test_what_was_written_comes_back(results, mfr):  # noqa: F811
    ended = mfr("table", "results", "--parquet", "out")
    assert ended.status == 0 and ended.out.split() == [f"out/{n}.parquet" for n in ("cells", "passes", "samples")]
    before, after = mfr_bench.load("results"), mfr_bench.load("out")
    for name in ("cells", "passes", "samples"):
        one, other = getattr(before, name), getattr(after, name)
        pd.testing.assert_frame_equal(one, other)
        assert one.attrs == other.attrs and other.attrs["units"]["time_ms"] == "ms"
    assert after.manifests == before.manifests
    both = mfr_bench.load("out", "results")
    assert len(both.cells) == 2 * len(before.cells) and both.cells.attrs == before.cells.attrs


def test_units_and_types_stand_in_the_file(results, mfr):  # noqa: F811
    mfr("table", "results", "--parquet", "out")
    file = fastparquet.ParquetFile("out/cells.parquet")
    about = json.loads(file.key_value_metadata[KEY])
    assert about["schema"] == 1 and about["units"]["memory_bytes"] == "bytes" and about["types"]["params"] == "object"
    assert json.loads(file.to_pandas()["params"].iloc[1]) == {"k": 4}


def test_without_the_library_one_line_says_what_to_install(results, mfr, monkeypatch):  # noqa: F811
    monkeypatch.setitem(sys.modules, "fastparquet", None)
    ended = mfr("table", "results", "--parquet", "out")
    assert (ended.status, ended.err) == (
        1, "Parquet needs the package fastparquet; install mfr-bench[parquet]\n")


@pytest.mark.parametrize("content", [b"", b"PAR1", b"no such file"])
def test_another_file_is_refused(results, content):
    (results / "out").mkdir()
    (results / "out" / "cells.parquet").write_bytes(content)
    with pytest.raises(UsageError, match=r"cells\.parquet: cannot be read"):
        mfr_bench.load("out")


def test_parquet_of_another_program_is_refused(results):
    (results / "out").mkdir()
    fastparquet.write("out/cells.parquet", pd.DataFrame({"a": [1]}))
    with pytest.raises(MfrError, match="is none of mfr-bench"):
        mfr_bench.load("out")


def test_a_damaged_cell_is_left_out_and_told(results, mfr):  # noqa: F811
    cell = min((results / "results").rglob("cells/*.json"))
    cell.write_text("{")
    ended = mfr("table", "results", "--parquet", "out")
    assert ended.status == 0 and cell.name in ended.err and len(ended.out.split()) == 3

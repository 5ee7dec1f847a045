"""`submit-results` and `verify` as commands: what they say, and how they end."""

from __future__ import annotations

from ..cli.conftest import mfr  # noqa: F401
from ..merge.test_merge import folder, record


def test_from_results_to_a_collection(tmp_path, mfr):  # noqa: F811
    source = folder(tmp_path / "n1", record("ab-array"), record("ab-ll"))
    made = mfr("submit-results", source.path, "--sign-off", "A. Smith", "--out", tmp_path / "b.zip")
    assert made.status == 0 and "result folders: 1," in made.out, made.err
    done = mfr("verify", tmp_path / "b.zip", "--into", tmp_path / "collection")
    assert done.status == 0 and "cells: 2, odd: nothing" in done.out and "cells: 2, new: 2" in done.out
    assert list((tmp_path / "collection").rglob("tables/results.md")), "the merged set has its tables"
    again = mfr("verify", tmp_path / "b.zip", "--into", tmp_path / "collection")
    assert again.status == 0 and "cells: 2, new: 0" in again.out


def test_what_is_odd_ends_with_3_and_is_not_taken(tmp_path, mfr):  # noqa: F811
    source = folder(tmp_path / "n1", record("floor", values={"time_ms": 3.0}), record("ab-array"))
    assert mfr("submit-results", source.path, "--sign-off", "A. Smith", "--out", tmp_path / "b.zip").status == 0
    done = mfr("verify", tmp_path / "b.zip", "--into", tmp_path / "collection")
    assert done.status == 3 and "drawing the geometry alone" in done.out and not (tmp_path / "collection").exists()


def test_what_is_no_bundle_ends_with_2_in_one_line(tmp_path, mfr):  # noqa: F811
    (tmp_path / "b.zip").write_bytes(b"no zip")
    done = mfr("verify", tmp_path / "b.zip")
    assert done.status == 2 and done.err.count("\n") == 1 and "refused" in done.err
    assert mfr("verify", tmp_path / "none.zip").err.startswith(f"{tmp_path / 'none.zip'}: no such file")

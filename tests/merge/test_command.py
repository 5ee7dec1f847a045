"""`mfr-bench merge`: what it says, how it ends, and that every command reads what it wrote."""

from __future__ import annotations

from ..cli.conftest import mfr  # noqa: F401
from .test_merge import DEVICE, folder, record


def test_two_machines_results_are_one_set(tmp_path, mfr):  # noqa: F811
    n1, n2 = folder(tmp_path / "n1", record("ab-array")), folder(tmp_path / "n2", record("ab-ll"))
    done = mfr("merge", n1.path, n2.path, "--into", tmp_path / "all")
    assert done.status == 0, done.err
    assert f"{tmp_path / 'all'}: cells: 2, new: 2, merged folders: 2" in done.out
    assert (tmp_path / "all" / "results.csv").read_text().count("planted") == 2
    shown = mfr("table", tmp_path / "all")
    assert shown.status == 0 and "ab-array" in shown.out and "ab-ll" in shown.out
    again = mfr("merge", n2.path, n1.path, "--into", tmp_path / "all")
    assert "cells: 2, new: 0" in again.out


def test_a_contradiction_ends_with_2_and_writes_nothing(tmp_path, mfr):  # noqa: F811
    n1 = folder(tmp_path / "n1", record("ab-array"))
    n2 = folder(tmp_path / "n2", record("ab-array", values={"max_abs_error": 0.5}))
    done = mfr("merge", n1.path, n2.path, "--into", tmp_path / "all")
    assert done.status == 2 and "values.max_abs_error" in done.err and "nothing was merged" in done.err
    assert not (tmp_path / "all").exists()


def test_sets_of_several_devices_are_named(tmp_path, mfr):  # noqa: F811
    other = DEVICE | {"slug": "card-b", "renderer": "Card B"}
    done = mfr("merge", folder(tmp_path / "n1", record("ab-array")).path,
               folder(tmp_path / "n2", record("ab-ll", device=other), device=other).path,
               "--into", tmp_path / "all")
    assert done.status == 0 and "all/card-a/planted: cells: 1," in done.out and "all/card-b/planted" in done.out


def test_an_empty_name_is_no_place(tmp_path, mfr, monkeypatch):  # noqa: F811
    monkeypatch.chdir(tmp_path)
    source = folder(tmp_path / "n1", record("ab-array")).path
    for command in (("merge", source, "--into", ""), ("verify", "b.zip", "--into", ""), ("collect", "s", "--into", ""),
                    ("submit-results", source, "--sign-off", "A. Smith", "--out", "")):
        done = mfr(*command)
        assert done.status == 2 and "'' is no place to write to" in done.err, command
    assert sorted(path.name for path in tmp_path.iterdir()) == ["n1"]

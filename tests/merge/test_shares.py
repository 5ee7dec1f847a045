"""Shares of a run that are measured apart and merged: the rows of the whole run, each once."""

from __future__ import annotations

import csv

from ..cli.conftest import FIGURE, TINY, mfr, on_device  # noqa: F401


def rows_of(path):
    with open(path / "results.csv", newline="", encoding="utf-8") as file:
        return [(row["key"], row["method"], row["depth_complexity"], row["status"]) for row in csv.DictReader(file)]


def test_merged_shares_are_the_whole_run(mfr, on_device, tmp_path, monkeypatch):  # noqa: F811
    monkeypatch.chdir(tmp_path)
    several = TINY.replace("sweep: {", "sweep: {scene.depth_complexity: [2, 3, 4], ")
    (tmp_path / "tiny.yaml").write_text(several + FIGURE)
    assert mfr("run", "tiny.yaml", "--out", "whole").status == 0
    for number in (1, 2):
        assert mfr("run", "tiny.yaml", "--shard", f"{number}/2", "--out", f"node{number}").status == 0
    drawn = [folder for folder in ("whole", "node1", "node2") if (tmp_path / folder / "figures").exists()]
    assert drawn == ["whole"]
    done = mfr("merge", "node1", "node2", "--into", "merged")
    assert done.status == 0, done.err
    assert rows_of(tmp_path / "merged") == rows_of(tmp_path / "whole")
    more = mfr("run", "tiny.yaml", "--shard", "4/4", "--out", "node4")
    assert more.status == 2 and "at most 3 shares" in more.err
